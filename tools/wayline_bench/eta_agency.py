"""Vehicles of an agency that say nothing of their trips, through eta's cores in one process."""

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wayline.messages import GpsFix, Message, Pose, Progress
from wayline.timetable.calendar import SECOND_NS
from wayline.timetable.loading import load_timetable
from wayline.timetable.runs import Run, Runs
from wayline.tuning import Tuning
from wayline_bench.rounds import Say, cpu_s
from wayline_bench.row import Row, compared
from wayline_bench.timetable import clock_of, write_tables
from wayline_eta.timetable_core import timetable_node

VEHICLES = 1_000
"""As many are reckoned from the hundred that are under way in the town."""
REPORT_S, MINUTES = 30, 4
LINES, STOPS = 10, 30
HEADWAY_S, LEG_S = 360, 90
BEGIN_NS = 1_781_258_400_000_000_000
"""A Friday, noon in Berlin."""
FOUND = 0.9
"""On their trips at the end; two lines may go the same way for as long."""
BAR = 0.5
"""Of a core; the rest is for what the messages cost."""


class Bus(NamedTuple):
    """One vehicle on a trip that it does not name, and when it reports."""

    run: Run
    offset_s: int


def agency_row(say: Say) -> Row:
    """What they take of a core, from the first report on."""
    with tempfile.TemporaryDirectory(prefix="wayline-bench-") as temporary:
        feed = Path(temporary) / "feed"
        write_town(feed)
        runs = Runs([load_timetable(feed, None)])
    buses = list(_under_way(runs))
    say(f"{VEHICLES:,} vehicles without assignment")
    heard = [list(_heard(bus)) for bus in buses]
    nodes = [timetable_node(runs, Tuning(), None) for _ in buses]
    told: list[list[Message]] = []

    def through() -> None:
        for node, messages in zip(nodes, heard, strict=True):
            told.append([said for each in messages for said in node.take(each, "bench")])

    spent_s = cpu_s(through) * VEHICLES / len(buses)
    found = sum(map(_is_right, buses, told))
    if found < FOUND * len(buses):
        raise AssertionError(f"of {len(buses)} vehicles only {found} were found on their trips")
    what = f"{VEHICLES:,} vehicles without assignment, a report every {REPORT_S} s"
    return compared(what, [spent_s], [60.0 * MINUTES], "as long as it takes", unit="s", bar=BAR)


def _is_right(bus: Bus, told: Sequence[Message]) -> bool:
    """Whether a vehicle is on its trip at last."""
    last = [each for each in told if isinstance(each, Progress)][-1:]
    return [each.trip_id for each in last] == [bus.run.trip.trip_id]


def _under_way(runs: Runs) -> Iterator[Bus]:
    """Of every pattern those that are neither at its begin nor at its end meanwhile."""
    ends_ns = BEGIN_NS + 60 * MINUTES * SECOND_NS
    for pattern in range(len(runs.feeds[0].patterns)):
        for number, run in enumerate(runs.of_pattern((0, pattern), BEGIN_NS)):
            if run.departs_ns < BEGIN_NS and ends_ns < run.ends_ns:
                yield Bus(run, (7 * pattern + 11 * number) % REPORT_S)


def _heard(bus: Bus) -> Iterator[Message]:
    """Its reports, and each second the pose that is made of the last one."""
    route, run = bus.run.trip_route.route, bus.run
    for second in range(bus.offset_s, 60 * MINUTES):
        since_s = (second - bus.offset_s) % REPORT_S
        t_ns = BEGIN_NS + second * SECOND_NS
        reported_ns = t_ns - since_s * SECOND_NS
        share = (reported_ns - run.departs_ns) / (run.ends_ns - run.departs_ns)
        lat_deg, lon_deg, _ = route.line.point_at(share * route.length_m)
        if since_s == 0:
            yield GpsFix(t_ns=t_ns, valid=True, lat_deg=lat_deg, lon_deg=lon_deg)
        yield Pose(t_ns=t_ns, mode="gps", lat_deg=lat_deg, lon_deg=lon_deg, distance_m=0.0)


def write_town(folder: Path) -> None:
    """A feed of LINES lines that wind through one another, each driven both ways."""
    lines = [(line, way) for line in range(LINES) for way in (0, 1)]
    trips = [
        (f"T{line}-{way}-{at}", line, way, 5 * 3600 + at * HEADWAY_S)
        for line, way in lines
        for at in range(100)
    ]
    tables = {
        "routes": ["route_id,agency_id,route_short_name,route_type"]
        + [f"R{line},A,{line},3" for line in range(LINES)],
        "stops": ["stop_id,stop_name,stop_lat,stop_lon"]
        + [
            f"S{line}-{at},Stop {at},{lat_deg:.6f},{lon_deg:.6f}"
            for line in range(LINES)
            for at, (lat_deg, lon_deg) in enumerate(_street(line, STOPS))
        ],
        "shapes": ["shape_id,shape_pt_sequence,shape_pt_lat,shape_pt_lon"]
        + [
            f"P{line}-{way},{at},{lat_deg:.6f},{lon_deg:.6f}"
            for line, way in lines
            for at, (lat_deg, lon_deg) in enumerate(_street(line, 300)[:: -1 if way else 1])
        ],
        "trips": ["route_id,service_id,trip_id,direction_id,shape_id"]
        + [f"R{line},S,{name},{way},P{line}-{way}" for name, line, way, _ in trips],
        "stop_times": ["trip_id,arrival_time,departure_time,stop_id,stop_sequence"]
        + [
            f"{name},{clock},{clock},S{line}-{STOPS - 1 - at if way else at},{at + 1}"
            for name, line, way, starts_s in trips
            for at in range(STOPS)
            for clock in (clock_of(starts_s + LEG_S * at),)
        ],
    }
    write_tables(folder, tables)


def _street(line: int, points: int) -> list[tuple[float, float]]:
    """Ten kilometres to the north, in a wave that crosses the other lines'."""
    share = np.linspace(0.0, 1.0, points)
    lons_deg = 8.0 + 0.004 * line + 0.01 * np.sin(2.0 * np.pi * (2.0 * share + line / LINES))
    return list(zip((50.0 + 0.09 * share).tolist(), lons_deg.tolist(), strict=True))
