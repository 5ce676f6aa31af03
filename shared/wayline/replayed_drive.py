"""Pure: what a replay gives to the services whose cores run in it."""

from typing import NamedTuple

from wayline.drive import Drive
from wayline.route import Route
from wayline.timetable.model import Timetable


class ReplayedDrive(NamedTuple):
    """A drive that is replayed, with what is known besides its recordings."""

    drive: Drive
    routes: tuple[Route, ...]
    """What the vehicle may follow, where that is known."""
    database_url: str | None
    """Where what is learned is kept; without, it goes with the replay."""
    timetables: tuple[Timetable, ...] = ()
    """What trips there are."""
