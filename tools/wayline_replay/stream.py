"""A drive's messages in order of receipt, from all its recordings."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from wayline.drive import Drive
from wayline.drive_file import load_drive
from wayline.received import Received, Sources
from wayline_replay.outages import Outage, check_outages
from wayline_replay.parts import recordings


class DriveStream(Sources):
    """Iterates once over a drive's messages in order of receipt.

    `where` names the drive file in errors. Raises InputError, at the latest at the end where
    nothing of the drive could be read.
    """

    def __init__(self, drive: Drive, where: str) -> None:
        super().__init__(recordings(drive, where))

    def __iter__(self) -> Iterator[Received]:
        yield from super().__iter__()
        self.check()


def check_outages_of(folder: Path, outages: Sequence[Outage]) -> None:
    """Raise InputError for an outage that begins behind the end of the drive in `folder`."""
    if outages:
        check_outages(DriveStream(load_drive(folder), str(folder)), outages)
