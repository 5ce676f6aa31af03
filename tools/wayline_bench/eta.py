"""`bench eta`: what following a vehicle and telling its arrivals costs, beside bare filterpy."""

from collections.abc import Iterator
from functools import partial

import numpy as np
from filterpy.kalman import KalmanFilter

from wayline.inputs import Tick
from wayline.line import Line
from wayline.messages import GpsFix, Pose
from wayline.route import Route, make_route
from wayline.stops import StopPlace
from wayline.tuning import Tuning
from wayline_bench.eta_agency import agency_row
from wayline_bench.eta_http import http_rows
from wayline_bench.rounds import Say, Work, cpu_s, in_turns
from wayline_bench.row import Row, compared
from wayline_eta.core import EtaCore

START_NS = 1_750_000_000_000_000_000
SECOND_NS = 1_000_000_000
STOPS = 30
LEGS = 200
"""Of the route's line, as a town's line has them."""
ROUNDS = 9
POSES = 400
"""Of a round."""
POSE_BAR = 8.0
VEHICLES, HZ = 40, 10
"""Whose poses come 400 times a second together."""
REPORTING, REPORT_S = 1_000, 30
SPEED_MPS = 8.0
KEEPS_UP = "as long as it takes"


def bench(say: Say) -> list[Row]:
    """Every row; needs no recorded data."""
    route = town_route()
    ours = [pose_row(route, say), poses_row(route, say), reports_row(route, say)]
    return [*ours, agency_row(say), *http_rows(say)]


def town_route() -> Route:
    """Ten kilometres to the north in a gentle wave, 30 stops with dwells."""
    north_deg = np.linspace(50.0, 50.09, LEGS + 1)
    east_deg = 8.0 + 0.002 * np.sin(np.linspace(0.0, 20.0, LEGS + 1))
    line = Line(north_deg, east_deg)
    stops = [
        StopPlace(f"s{stop}", f"Stop {stop}", *line.point_at(along_m)[:2], 20.0)
        for stop, along_m in enumerate(np.linspace(2_000.0, line.length_m, STOPS))
    ]
    return make_route(
        "bench",
        route_id="r",
        name="R",
        loop=False,
        vertices=list(zip(north_deg.tolist(), east_deg.tolist(), strict=True)),
        speeds_mps=None,
        stops=stops,
    )


def poses(route: Route, *, hz: int = 1, start_ns: int = START_NS) -> Iterator[Pose]:
    """A vehicle's drive along the line's first two kilometres, to and again: 30 stops ahead."""
    number = 0
    while True:
        along_m = (number * SPEED_MPS / hz) % 1_900.0
        lat_deg, lon_deg, heading_deg = route.line.point_at(along_m)
        yield Pose(
            t_ns=start_ns + number * SECOND_NS // hz,
            mode="fused",
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            heading_deg=heading_deg,
            speed_mps=SPEED_MPS,
            distance_m=number * SPEED_MPS / hz,
            east_std_m=3.0,
            north_std_m=3.0,
        )
        number += 1


class BareKalman:
    """Two states, constant matrices, a measurement of one number."""

    def __init__(self) -> None:
        self._filter = kalman = KalmanFilter(dim_x=2, dim_z=1)
        kalman.F, kalman.H = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[1.0, 0.0]])
        self._z = np.array([0.5])

    def steps(self, count: int) -> None:
        """Predict and update."""
        for _ in range(count):
            self._filter.predict()
            self._filter.update(self._z)


class Followed:
    """A core that is told a pose a second and tells progress and arrivals of each."""

    def __init__(self, route: Route) -> None:
        self._core = EtaCore([route], Tuning())
        made = poses(route)
        self._rounds = iter([[next(made) for _ in range(POSES)] for _ in range(ROUNDS + 1)])

    def steps(self) -> None:
        """The next round."""
        for pose in next(self._rounds):
            self._core.handle(pose, "bench")
            self._core.handle(Tick(pose.t_ns), "bench")


def pose_row(route: Route, say: Say) -> Row:
    """One pose, to progress and the arrivals at 30 stops."""
    works: dict[str, Work] = {
        "ours": Followed(route).steps,
        "bare": partial(BareKalman().steps, POSES),
    }
    spent_s = in_turns(works, ROUNDS, lambda progress: say(f"poses: {progress}"))
    us = {work: [each * 1e6 / POSES for each in rounds] for work, rounds in spent_s.items()}
    what = f"1 pose to progress and {STOPS} arrivals"
    yardstick = "filterpy predict, update of 2 states"
    return compared(what, us["ours"], us["bare"], yardstick, unit="us", bar=POSE_BAR)


def poses_row(route: Route, say: Say) -> Row:
    """A second of 40 vehicles whose poses come ten times a second."""
    say(f"{VEHICLES} vehicles at {HZ} Hz")
    seconds = 10
    cores = [EtaCore([route], Tuning()) for _ in range(VEHICLES)]
    made = [poses(route, hz=HZ) for _ in range(VEHICLES)]
    drives = [[next(each) for _ in range(HZ * seconds)] for each in made]

    def through() -> None:
        for core, drive in zip(cores, drives, strict=True):
            for pose in drive:
                core.handle(pose, "bench")
                core.handle(Tick(pose.t_ns), "bench")

    what = f"{VEHICLES * HZ} poses a second, in one process"
    return compared(what, [cpu_s(through)], [float(seconds)], KEEPS_UP, unit="s", bar=1.0)


def reports_row(route: Route, say: Say) -> Row:
    """Thousand vehicles that report every 30 s, told of every second."""
    say(f"{REPORTING} vehicles every {REPORT_S} s")
    tenth, minutes = REPORTING // 10, 2
    cores = [EtaCore([route], Tuning()) for _ in range(tenth)]

    def through() -> None:
        for core in cores:
            for second in range(60 * minutes):
                _tell(core, route, second)

    spent_s = cpu_s(through) * 10.0
    what = f"{REPORTING:,} vehicles reporting every {REPORT_S} s, in one process"
    return compared(what, [spent_s], [60.0 * minutes], KEEPS_UP, unit="s", bar=1.0)


def _tell(core: EtaCore, route: Route, second: int) -> None:
    t_ns = START_NS + second * SECOND_NS
    if second % REPORT_S == 0:
        lat_deg, lon_deg, course_deg = route.line.point_at(6.0 * second)
        report = GpsFix(
            t_ns=t_ns, valid=True, lat_deg=lat_deg, lon_deg=lon_deg, course_deg=course_deg
        )
        core.handle(report, "bench")
    core.handle(Tick(t_ns), "bench")
