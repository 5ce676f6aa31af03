from wayline.inputs import Tick
from wayline.keys import FLEET
from wayline.messages import Health, Pose
from wayline_dashboard.core import ServiceEvent
from wayline_dashboard.fleet import Cursor, Fleet

NOW_NS = 1_700_000_000_000_000_000


def pose(step: int) -> Pose:
    return Pose(t_ns=NOW_NS + step, mode="gps", lat_deg=39.9 + step * 1e-3, lon_deg=-75.35)


def test_a_reader_first_gets_a_snapshot_then_only_what_changed() -> None:
    fleet, cursor = Fleet(), Cursor()
    fleet.handle("alpha", pose(0), "fusion", NOW_NS)
    fleet.handle("beta", pose(0), "fusion", NOW_NS)
    first = fleet.read(cursor, NOW_NS)
    assert first is not None
    assert (first.kind, [v.vehicle_id for v in first.vehicles]) == ("snapshot", ["alpha", "beta"])
    assert fleet.read(cursor, NOW_NS) is None
    fleet.handle("beta", pose(1), "fusion", NOW_NS)
    then = fleet.read(cursor, NOW_NS)
    assert then is not None
    assert (then.kind, [v.vehicle_id for v in then.vehicles]) == ("changes", ["beta"])


def test_the_snapshot_of_an_empty_fleet_is_told_too() -> None:
    view = Fleet().read(Cursor(), NOW_NS)
    assert view is not None
    assert (view.kind, view.vehicles) == ("snapshot", ())


def test_a_slow_reader_gets_the_newest_once() -> None:
    fleet, cursor = Fleet(), Cursor()
    fleet.read(cursor, NOW_NS)
    for step in range(100):
        fleet.handle("alpha", pose(step), "fusion", NOW_NS)
    view = fleet.read(cursor, NOW_NS)
    assert view is not None
    [vehicle] = view.vehicles
    assert vehicle.pose is not None
    assert vehicle.pose.lat_deg == pose(99).lat_deg
    assert len(vehicle.trail) == 100
    assert fleet.read(cursor, NOW_NS) is None


def test_a_tick_changes_nothing_and_hides_no_change() -> None:
    fleet, cursor = Fleet(), Cursor()
    fleet.handle("alpha", pose(0), "fusion", NOW_NS)
    fleet.handle("beta", pose(0), "fusion", NOW_NS)
    fleet.read(cursor, NOW_NS)
    fleet.handle("alpha", pose(1), "fusion", NOW_NS)
    fleet.handle("beta", Tick(NOW_NS), "clock", NOW_NS)
    view = fleet.read(cursor, NOW_NS)
    assert view is not None
    assert [v.vehicle_id for v in view.vehicles] == ["alpha"]


def test_services_of_the_fleet_are_apart_from_a_vehicles_own() -> None:
    fleet, cursor = Fleet(), Cursor()
    fleet.handle(FLEET, ServiceEvent("eta", up=True), "", NOW_NS)
    fleet.handle(
        "alpha", Health(t_ns=0, service="fusion", version="1", started_ns=0), "fusion", NOW_NS
    )
    first = fleet.read(cursor, NOW_NS)
    assert first is not None
    assert [service.service for service in first.services or ()] == ["eta"]
    assert [service.service for service in first.vehicles[0].services or ()] == ["fusion"]
    fleet.handle(FLEET, ServiceEvent("eta", up=False), "", NOW_NS)
    then = fleet.read(cursor, NOW_NS)
    assert then is not None
    assert then.vehicles == ()
    assert [service.up for service in then.services or ()] == [False]


def test_the_snapshot_lists_vehicles_by_id() -> None:
    fleet = Fleet()
    for vehicle_id in ("gamma", "alpha", "beta"):
        fleet.handle(vehicle_id, pose(0), "fusion", NOW_NS)
    ids = [vehicle.vehicle_id for vehicle in fleet.snapshot(NOW_NS).vehicles]
    assert ids == ["alpha", "beta", "gamma"]


def test_a_pose_says_when_it_was_heard_for_ages_of_recordings() -> None:
    fleet, cursor = Fleet(), Cursor()
    fleet.handle("alpha", pose(0), "fusion", NOW_NS + 5_000_000_000)
    view = fleet.read(cursor, NOW_NS)
    assert view is not None
    assert view.vehicles[0].heard == "2023-11-14T22:13:25.000Z"
    fleet.handle("alpha", ServiceEvent("eta", up=True), "", NOW_NS + 9_000_000_000)
    view = fleet.read(cursor, NOW_NS)
    assert view is not None
    assert view.vehicles[0].heard is None
