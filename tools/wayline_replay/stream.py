"""A drive's messages in order of arrival, from all its recordings."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from wayline.arrival import Arrival, Sources
from wayline.drive import Drive, load_drive
from wayline_can_ingest import recorded as can
from wayline_gps_ingest import recorded as gps
from wayline_replay.outages import Outage, check_outages


class DriveStream(Sources):
    """Iterates once over a drive's messages in order of arrival.

    `where` names the drive file in errors. Raises InputError, at the latest at the end where
    nothing of the drive could be read.
    """

    def __init__(self, drive: Drive, where: str) -> None:
        super().__init__([*gps.recordings(drive), *can.recordings(drive, where)])

    def __iter__(self) -> Iterator[Arrival]:
        yield from super().__iter__()
        self.check()


def check_outages_of(folder: Path, outages: Sequence[Outage]) -> None:
    """Raise InputError for an outage that begins behind the end of the drive in `folder`."""
    if outages:
        check_outages(DriveStream(load_drive(folder), str(folder)), outages)
