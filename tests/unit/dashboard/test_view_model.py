import time
from collections.abc import Sequence
from itertools import pairwise

from wayline.messages import (
    Arrivals,
    FusionStatus,
    GpsFix,
    Health,
    Horizon,
    HorizonPoint,
    Message,
    Odometer,
    Pose,
    Progress,
    SensorSlope,
    StopArrival,
    Verdict,
)
from wayline.view import Receipt
from wayline_dashboard.instant import Instant
from wayline_dashboard.trail import POINTS_MAX, SPACING_M
from wayline_dashboard.view import VehicleView
from wayline_dashboard.view_model import UNTOLD, VehicleViewModel

START_NS = 1_321_322_166_504_000_000  # 2011-11-15T01:56:06.504Z
SECOND_NS = 1_000_000_000
NOW = Instant(START_NS, 0)
DEG_PER_M = 1.0 / 111_050.0  # of latitude, near 39.9 degrees


def pose(step: int, north_m: float = 0.0) -> Pose:
    return Pose(
        t_ns=START_NS + step * SECOND_NS // 10,
        mode="fused",
        lat_deg=39.906 + north_m * DEG_PER_M,
        lon_deg=-75.350,
        heading_deg=90.0,
        speed_mps=8.0,
        east_std_m=3.0,
        north_std_m=1.0,
        east_north_cov_m2=0.0,
    )


class Told:
    """A view model, numbered as a fleet numbers it, and what a reader is told of it."""

    def __init__(self, *messages: Message, source: str = "fusion") -> None:
        self.model = VehicleViewModel("shuttle")
        self.revision = 0
        self.put(*messages, source=source)

    def put(self, *messages: Message, source: str = "fusion") -> list[bool]:
        return [self._put(message, source) for message in messages]

    def put_service(self, service: str, *, up: bool) -> None:
        self.revision += 1
        self.model.put_service(service, up, self.revision)

    def since(self, known: int = UNTOLD) -> VehicleView:
        return self.model.whole_view(known, NOW)

    def _put(self, message: Message, source: str) -> bool:
        self.revision += 1
        return self.model.put(message, source, Receipt(0), self.revision)


def poses(count: int, spacing_m: float) -> Sequence[Pose]:
    return [pose(step, north_m=step * spacing_m) for step in range(count)]


def test_what_the_page_does_not_show_changes_nothing() -> None:
    told = Told()
    assert told.put(Odometer(t_ns=START_NS, speed_mps=1.0), pose(0)) == [False, True]


def test_a_pose_becomes_a_place_with_an_ellipse() -> None:
    told = Told()
    told.put(pose(0))
    view = told.since().pose
    assert view is not None
    assert (view.t, view.mode, view.heading_deg) == ("2011-11-15T01:56:06.504Z", "fused", 90.0)
    assert view.ellipse is not None
    assert (view.ellipse.semi_major_m, view.ellipse.orientation_deg) == (3.0, 90.0)


def test_the_raw_fix_stays_beside_the_pose() -> None:
    told = Told()
    told.put(pose(0))
    fix = GpsFix(t_ns=START_NS, valid=True, lat_deg=39.907, lon_deg=-75.351, fix="gps")
    told.put(fix, source="gps-ingest-2")
    view = told.since()
    assert view.fix is not None
    assert (view.fix.lat_deg, view.fix.source) == (39.907, "gps-ingest-2")
    assert view.pose is not None
    assert view.pose.lat_deg == 39.906


def test_only_what_changed_is_told_again() -> None:
    told = Told()
    told.put(pose(0))
    told.put(FusionStatus(t_ns=START_NS))
    known = told.revision
    told.put(pose(1, north_m=10.0))
    changes = told.since(known)
    assert changes.pose is not None
    assert changes.status is None
    assert len(changes.trail) == 1
    assert not changes.trail_restart


def test_a_reader_that_knows_nothing_takes_the_whole_trail() -> None:
    told = Told()
    told.put(pose(0))
    told.put(pose(1, north_m=10.0))
    assert told.since().trail_restart
    assert len(told.since().trail) == 2


def test_the_trail_is_thinned_to_its_spacing() -> None:
    told = Told()
    told.put(*poses(101, 1.0))
    trail = told.since().trail
    steps_m = [(after.lat_deg - before.lat_deg) / DEG_PER_M for before, after in pairwise(trail)]
    assert 15 <= len(trail) <= 101 / SPACING_M + 1
    assert min(steps_m) >= SPACING_M - 0.01


def test_a_reader_too_far_behind_takes_the_trail_anew() -> None:
    told = Told()
    told.put(pose(0))
    known = told.revision
    told.put(*poses(POINTS_MAX + 50, 5.0)[1:])
    changes = told.since(known)
    assert changes.trail_restart
    assert len(changes.trail) == POINTS_MAX


def test_a_late_pose_does_not_move_the_vehicle_back() -> None:
    told = Told()
    told.put(pose(5, north_m=5.0))
    told.put(pose(4, north_m=4.0))
    view = told.since().pose
    assert view is not None
    assert view.t == "2011-11-15T01:56:07.004Z"


def test_a_drive_played_again_begins_a_new_trail() -> None:
    told = Told()
    told.put(*poses(200, 5.0))
    known = told.revision
    told.put(pose(0))
    changes = told.since(known)
    assert changes.pose is not None
    assert changes.pose.t == "2011-11-15T01:56:06.504Z"
    assert changes.trail_restart
    assert len(changes.trail) == 1


def test_arrivals_come_soonest_first() -> None:
    told = Told()
    stops = tuple(
        StopArrival(
            stop_id=name,
            name=name.title(),
            distance_m=100.0,
            arrival_ns=START_NS + in_s * SECOND_NS,
            early_ns=START_NS + (in_s - 5) * SECOND_NS,
            late_ns=START_NS + (in_s + 9) * SECOND_NS,
        )
        for name, in_s in (("library", 90), ("station", 30))
    )
    told.put(Arrivals(t_ns=START_NS, route_id="avl", stale=False, stops=stops))
    view = told.since().arrivals
    assert view is not None
    assert [stop.name for stop in view.stops] == ["Station", "Library"]
    assert view.stops[0].arrival == "2011-11-15T01:56:36.504Z"
    assert view.stops[0].late == "2011-11-15T01:56:45.504Z"


def test_progress_and_horizon_fill_their_sections() -> None:
    told = Told()
    told.put(
        Progress(
            t_ns=START_NS,
            route_id="avl",
            distance_m=120.0,
            lat_deg=39.906,
            lon_deg=-75.35,
            cross_track_m=-2.0,
            distance_std_m=3.0,
            on_route=True,
            speed_mps=8.0,
        )
    )
    point = HorizonPoint(distance_m=20.0, grade_pct=None, runs=0)
    told.put(Horizon(t_ns=START_NS, road_id="avl", points=(point,)))
    view = told.since()
    assert view.progress is not None
    assert view.progress.cross_track_m == -2.0
    assert view.horizon is not None
    assert view.horizon.points[0].grade_pct is None


def test_the_last_rejection_outlives_the_status_that_told_it() -> None:
    told = Told()
    refused = Verdict(
        sensor="gps_position", t_ns=START_NS, accepted=False, nis=80.0, threshold=9.2, reason="gate"
    )
    told.put(FusionStatus(t_ns=START_NS, rejected=1, verdicts=(refused,)))
    told.put(FusionStatus(t_ns=START_NS + SECOND_NS, rejected=1))
    view = told.since().status
    assert view is not None
    assert view.last_rejection == "gps_position: gate"


def test_the_slope_of_a_sensor_that_was_just_refused_says_so() -> None:
    told = Told()
    refused = Verdict(
        sensor="barometer", t_ns=START_NS, accepted=False, nis=80.0, threshold=9.2, reason="gate"
    )
    slopes = tuple(
        SensorSlope(sensor=sensor, slope_pct=2.0, slope_std_pct=0.5)
        for sensor in ("barometer", "torque")
    )
    told.put(FusionStatus(t_ns=START_NS, rejected=1, verdicts=(refused,), slopes=slopes))
    view = told.since().status
    assert view is not None
    assert [(each.sensor, each.refused) for each in view.slopes] == [
        ("barometer", True),
        ("torque", False),
    ]


def test_a_service_that_lost_its_token_is_down_with_its_last_health() -> None:
    told = Told()
    told.put_service("eta", up=True)
    told.put(Health(t_ns=START_NS, service="eta", version="0.1.0", started_ns=0))
    told.put_service("eta", up=False)
    [service] = told.model.services()
    assert (service.service, service.up, service.version) == ("eta", False, "0.1.0")


def test_a_service_says_that_it_plays_a_recording() -> None:
    played = Health(t_ns=0, service="play", version="1", started_ns=0, recorded=True)
    told = Told(Health(t_ns=0, service="fusion", version="1", started_ns=0), played)
    assert [service.recorded for service in told.model.services()] == [False, True]


def test_a_pose_is_heard_as_long_ago_as_it_is_old() -> None:
    model = VehicleViewModel("shuttle")
    # two seconds old when it came at 5 s of the monotonic clock; asked at 6 s
    model.put(pose(0), "fusion", Receipt(5 * SECOND_NS, 2 * SECOND_NS), 1)
    now = Instant(START_NS + 60 * SECOND_NS, 6 * SECOND_NS)
    assert model.whole_view(UNTOLD, now).heard == "2011-11-15T01:57:03.504Z"


def test_what_a_reader_lacks_is_news() -> None:
    told = Told(pose(0))
    known = told.revision
    told.put(FusionStatus(t_ns=START_NS))
    assert not told.model.has_news(known, {Pose})
    assert told.model.has_news(known, {Pose, FusionStatus})
    assert told.model.has_news(known - 1, {GpsFix})  # the vehicle itself is new


def test_a_snapshot_of_an_unheard_vehicle_is_empty() -> None:
    view = Told().since()
    assert view.pose is None
    assert view.trail == ()


def test_a_pose_costs_microseconds() -> None:
    told = Told()
    driven = poses(5000, 0.8)
    best_s = float("inf")
    for _ in range(3):
        began_s = time.perf_counter()
        told.put(*driven)
        best_s = min(best_s, time.perf_counter() - began_s)
    assert best_s / len(driven) < 100e-6  # measured 2 us; a geodesic or a view each time is over
