"""Vehicles that are driven through the core of timetables, and what is told of them."""

import datetime as dt
from pathlib import Path
from zoneinfo import ZoneInfo

from unit.timetable.faulty_feeds import LAT_DEG, LON_DEG, STEP_DEG, good_feed, write_folder
from wayline.geo import wrap_180
from wayline.inputs import Tick
from wayline.messages import Arrivals, GpsFix, Message, Pose, Progress
from wayline.timetable.calendar import SECOND_NS, instant_ns
from wayline.timetable.reading import read_timetable
from wayline.timetable.runs import Runs
from wayline.tuning import Tuning
from wayline_eta.timetable_core import timetable_node

BERLIN = ZoneInfo("Europe/Berlin")
DAY = dt.date(2026, 6, 3)
NORTH_M = 111_194.9


def two_lines(folder: Path) -> Runs:
    """R goes on to the north at S2, Q turns to the east there; both at eight."""
    tables = good_feed()
    tables["routes.txt"] += "Q,A,2,3\n"
    tables["trips.txt"] += "Q,S,V,0,C,\n"
    tables["stops.txt"] += f"E3,East,{LAT_DEG + 2 * STEP_DEG},{LON_DEG + 0.0134}\n"
    tables["stop_times.txt"] += "".join(
        f"V,08:0{2 * at}:00,08:0{2 * at}:00,{stop},{at}\n"
        for at, stop in enumerate(("S0", "S1", "S2", "E3"))
    )
    return Runs([read_timetable(write_folder(tables, folder))])


class Ride:
    """A vehicle that is driven and what is told of it."""

    def __init__(
        self,
        runs: Runs,
        assignment: str | None = None,
        start: str = "08:00",
        every_s: int = 1,
        lon_deg: float = LON_DEG,
    ) -> None:
        hours, minutes = (int(part) for part in start.split(":"))
        self.t_ns = instant_ns(DAY, 3600.0 * hours + 60.0 * minutes, BERLIN)
        self._node = timetable_node(runs, Tuning(), assignment)
        self._travelled_m = 0.0
        self._every_s, self._second = every_s, 0
        self._lon_deg = lon_deg

    def at(
        self,
        north_m: float,
        east_m: float = 0.0,
        heading_deg: float = 0.0,
        speed_mps: float = 8.34,
    ) -> list[Message]:
        """One second further, at a place in metres from S0."""
        pose = Pose(
            t_ns=self.t_ns,
            mode="gps",
            lat_deg=LAT_DEG + north_m / NORTH_M,
            lon_deg=wrap_180(self._lon_deg + east_m / 74_250.0),
            heading_deg=heading_deg,
            speed_mps=speed_mps,
            distance_m=self._travelled_m,
            east_std_m=3.0,
            north_std_m=3.0,
        )
        if self._second % self._every_s == 0:
            self.report(pose)
        self._second += 1
        told = list(self._node.take(pose, "fusion"))
        self.t_ns += SECOND_NS
        self._travelled_m += speed_mps
        return told

    def report(self, pose: Pose | None = None, assignment: str | None = None) -> None:
        """A fix with the place of a pose, and what it names."""
        fix = GpsFix(
            t_ns=self.t_ns,
            valid=pose is not None,
            lat_deg=pose.lat_deg if pose else None,
            lon_deg=pose.lon_deg if pose else None,
            course_deg=pose.heading_deg if pose else None,
            speed_mps=pose.speed_mps if pose else None,
            assignment=assignment,
        )
        assert not list(self._node.take(fix, "gps-ingest"))

    def tick(self) -> list[Message]:
        return list(self._node.give(Tick(self.t_ns), "eta"))


def trips(told: list[Message]) -> list[str | None]:
    return [each.trip_id for each in told if isinstance(each, Progress)]


def stops(told: list[Message]) -> list[str]:
    [arrivals] = [each for each in told if isinstance(each, Arrivals)]
    return [stop.stop_id for stop in arrivals.stops]
