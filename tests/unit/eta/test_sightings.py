"""What is followed: poses while they are good, else reports at their own time."""

import msgspec
import pytest

from unit.eta.route_drives import SECOND_NS, START_NS, TOWN
from wayline.messages import GpsFix, Pose, PoseMode
from wayline.tuning import Tuning
from wayline_eta.sightings import Sightings


def fix(second: float, north_m: float = 0.0, **said: object) -> GpsFix:
    lat_deg, lon_deg = TOWN.to_geodetic(0.0, north_m)
    made = GpsFix(
        t_ns=START_NS + round(second * SECOND_NS), valid=True, lat_deg=lat_deg, lon_deg=lon_deg
    )
    return msgspec.structs.replace(made, **said)


def pose(second: float, mode: PoseMode = "gps", std_m: float = 5.0, north_m: float = 0.0) -> Pose:
    lat_deg, lon_deg = TOWN.to_geodetic(0.0, north_m)
    return Pose(
        t_ns=START_NS + round(second * SECOND_NS),
        mode=mode,
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        distance_m=north_m,
        east_std_m=std_m,
        north_std_m=std_m,
    )


def told(sightings: Sightings, *heard: GpsFix | Pose) -> list[tuple[float, bool]]:
    """Seconds of what is followed, and whether they are reports, as messages come."""
    seen = []
    for message in heard:
        if isinstance(message, GpsFix):
            sightings.take_fix(message, "gps-ingest")
        else:
            seen += sightings.take_pose(message)
    return [((one.pose.t_ns - START_NS) / SECOND_NS, one.reported) for one in seen]


def test_poses_are_followed_while_fixes_come_every_second() -> None:
    heard: list[GpsFix | Pose] = []
    for second in range(4):
        heard += [fix(second), pose(second)]
    assert told(Sightings(Tuning()), *heard) == [(second, False) for second in range(4)]


def test_reports_are_followed_at_their_own_time_and_not_before_it() -> None:
    """A replay hands over a report before the poses of the seconds that lead up to it."""
    sightings = Sightings(Tuning())
    assert told(sightings, fix(0), pose(0), fix(30), pose(1)) == [(0, False), (1, False)]
    assert told(sightings, pose(29)) == [(1, True)]
    assert told(sightings, pose(30)) == [(30, True)]
    assert sightings.by_reports
    assert sightings.stale_after_s == 90.0


def test_stale_is_three_usual_intervals_of_seldom_reports() -> None:
    sightings = Sightings(Tuning())
    for second in range(0, 601, 60):
        told(sightings, fix(second), pose(second))
    assert sightings.stale_after_s == 180.0


def test_wheels_reckon_on_between_seldom_reports() -> None:
    sightings = Sightings(Tuning())
    heard: list[GpsFix | Pose] = [
        fix(0),
        pose(0, "fused"),
        fix(30),
        pose(15, "dead_reckoning"),
        pose(30, "fused"),
    ]
    assert all(not reported for _, reported in told(sightings, *heard))


def test_an_unsure_pose_hands_over_to_reports_with_the_last_good_one() -> None:
    """Without wheels; the place that was known last is where the route goes on from."""
    sightings = Sightings(Tuning())
    assert told(sightings, fix(0), pose(0), fix(1), pose(1)) == [(0, False), (1, False)]
    assert told(sightings, pose(4, "dead_reckoning", 60.0)) == [(1, True)]
    assert told(sightings, fix(5), pose(5, "gps", 4.0)) == [(5, False)]


def test_reports_without_poses_are_followed() -> None:
    """Fusion is away."""
    sightings = Sightings(Tuning())
    sightings.take_fix(fix(3), "gps-ingest")
    [seen] = sightings.pass_time(START_NS + 4 * SECOND_NS)
    assert seen.reported


@pytest.mark.parametrize(
    "bad",
    [
        fix(29.0),  # out of order
        fix(30.0),  # doubled
        fix(31.0, valid=False),
        fix(31.0, lat_deg=None, valid=False),
        fix(3_600.0),  # from the future
    ],
)
def test_reports_that_are_no_news_are_not_followed(bad: GpsFix) -> None:
    sightings = Sightings(Tuning())
    for second in (0, 30):
        told(sightings, fix(second), pose(second))
    sightings.take_fix(bad, "gps-ingest")
    assert sightings.pass_time(START_NS + 45 * SECOND_NS) == []


def test_a_report_without_course_is_headed_from_the_one_before() -> None:
    """Of vehicles that stand it tells nothing, and a told course is an old one."""
    sightings = Sightings(Tuning())
    for second in (0, 30):
        told(sightings, fix(second), pose(second))
    sightings.take_fix(fix(60, 300.0), "gps-ingest")
    [north] = sightings.pass_time(START_NS + 60 * SECOND_NS)
    assert north.pose.heading_deg == pytest.approx(0.0, abs=0.1)
    assert north.pose.distance_m == pytest.approx(300.0, abs=0.5)
    sightings.take_fix(fix(90, 305.0, course_deg=270.0), "gps-ingest")
    [standing] = sightings.pass_time(START_NS + 90 * SECOND_NS)
    assert standing.pose.heading_deg is None


def test_a_derived_speed_is_none_that_was_told() -> None:
    sightings = Sightings(Tuning())
    for second, derived in ((0, True), (30, True), (60, False)):
        sightings.take_fix(fix(second, speed_mps=9.0, speed_derived=derived), "gps-ingest")
    seen = sightings.pass_time(START_NS + 60 * SECOND_NS)
    assert [one.pose.speed_mps for one in seen] == [None, None, 9.0]


def test_of_two_vehicles_with_one_id_one_is_followed() -> None:
    """They report in turns, ten kilometres apart."""
    sightings = Sightings(Tuning())
    for second in range(0, 300, 15):
        north_m = 10_000.0 if second % 30 else 8.0 * second
        sightings.take_fix(fix(second, north_m), "gps-ingest")
    seen = sightings.pass_time(START_NS + 300 * SECOND_NS)
    assert len(seen) == 10
    assert max(one.pose.distance_m for one in seen) == pytest.approx(8.0 * 270.0, abs=1.0)


def test_a_vehicle_that_was_put_elsewhere_is_followed_from_its_second_report_there() -> None:
    sightings = Sightings(Tuning())
    for second, north_m in ((0, 0.0), (30, 100.0), (60, 50_000.0), (90, 50_100.0)):
        sightings.take_fix(fix(second, north_m), "gps-ingest")
    seen = sightings.pass_time(START_NS + 90 * SECOND_NS)
    assert [(one.pose.t_ns - START_NS) // SECOND_NS for one in seen] == [0, 30, 90]
