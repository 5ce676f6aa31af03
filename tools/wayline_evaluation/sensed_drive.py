"""Reads what a drive's sensors measured."""

from pathlib import Path

from wayline.drive import Drive
from wayline_evaluation.sensed import Sensed, sensed_of
from wayline_replay.stream import DriveStream


def sense(drive: Drive, where: Path) -> Sensed:
    """Read a drive. Raises InputError."""
    return sensed_of(arrival.message for arrival in DriveStream(drive, str(where)))
