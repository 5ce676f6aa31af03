from wayline.keys import FLEET
from wayline.messages import FusionStatus, Health, Horizon, HorizonPoint, Message, Odometer, Pose
from wayline.view import Receipt
from wayline_dashboard.fleet import GONE_MAX, Cursor, Fleet
from wayline_dashboard.instant import Instant
from wayline_dashboard.view import FleetView, VehicleView

NOW_NS = 1_700_000_000_000_000_000
NOW = Instant(NOW_NS, 0)


def pose(step: int) -> Pose:
    return Pose(t_ns=NOW_NS + step, mode="gps", lat_deg=39.9 + step * 1e-3, lon_deg=-75.35)


def horizon(step: int, grade_pct: float) -> Horizon:
    point = HorizonPoint(distance_m=0.0, grade_pct=grade_pct, runs=1)
    return Horizon(t_ns=NOW_NS + step, road_id="avl", points=(point,))


def health(service: str) -> Health:
    return Health(t_ns=NOW_NS, service=service, version="1", started_ns=0)


class Told:
    """A fleet and one reader of it."""

    def __init__(self, **heard: Message) -> None:
        self.fleet, self.cursor = Fleet(), Cursor()
        self.hear(**heard)

    def hear(self, **heard: Message) -> None:
        for vehicle_id, message in heard.items():
            self.fleet.put(vehicle_id, message, "test", Receipt(0))

    def read(self) -> FleetView | None:
        return self.fleet.read(self.cursor, NOW)

    def news(self) -> FleetView:
        view = self.read()
        assert view is not None
        return view

    def vehicles(self) -> dict[str, VehicleView]:
        return {vehicle.vehicle_id: vehicle for vehicle in self.news().vehicles}

    def select(self, vehicle_id: str | None) -> VehicleView | None:
        self.cursor.select(vehicle_id)
        return self.vehicles().get(vehicle_id or "")


def test_a_reader_first_gets_a_snapshot_then_only_what_changed() -> None:
    told = Told(alpha=pose(0), beta=pose(0))
    first = told.news()
    assert first.kind == "snapshot"
    assert {vehicle.vehicle_id for vehicle in first.vehicles} == {"alpha", "beta"}
    assert told.read() is None
    told.hear(beta=pose(1))
    then = told.news()
    assert (then.kind, [v.vehicle_id for v in then.vehicles]) == ("changes", ["beta"])


def test_the_snapshot_of_an_empty_fleet_is_told_too() -> None:
    view = Told().news()
    assert (view.kind, view.vehicles, view.services) == ("snapshot", (), ())


def test_a_slow_reader_gets_the_newest_once() -> None:
    told = Told()
    told.select("alpha")
    for step in range(100):
        told.hear(alpha=pose(step))
    vehicle = told.vehicles()["alpha"]
    assert vehicle.pose is not None
    assert vehicle.pose.lat_deg == pose(99).lat_deg
    assert len(vehicle.trail) == 100
    assert told.read() is None


def test_what_is_not_shown_changes_nothing_and_hides_no_change() -> None:
    told = Told(alpha=pose(0), beta=pose(0))
    told.read()
    told.hear(alpha=pose(1))
    told.hear(beta=Odometer(t_ns=NOW_NS, speed_mps=1.0), gamma=Odometer(t_ns=NOW_NS))
    assert told.vehicles().keys() == {"alpha"}


def test_services_of_the_fleet_are_apart_from_a_vehicles_own() -> None:
    told = Told(alpha=health("fusion"))
    told.fleet.put_service(FLEET, "eta", up=True)
    told.cursor.select("alpha")
    first = told.news()
    assert [service.service for service in first.services or ()] == ["eta"]
    assert [service.service for service in first.vehicles[0].services or ()] == ["fusion"]
    told.fleet.put_service(FLEET, "eta", up=False)
    then = told.news()
    assert then.vehicles == ()
    assert [service.up for service in then.services or ()] == [False]


def test_the_snapshot_lists_vehicles_by_id() -> None:
    told = Told(gamma=pose(0), alpha=pose(0), beta=pose(0))
    ids = [vehicle.vehicle_id for vehicle in told.fleet.snapshot(None, NOW).vehicles]
    assert ids == ["alpha", "beta", "gamma"]


def test_a_snapshot_carries_the_horizon_and_the_trail_of_the_selected_vehicle_only() -> None:
    told = Told(alpha=pose(0), beta=pose(0))
    told.hear(alpha=horizon(0, 1.0), beta=horizon(0, 2.0))
    alpha, beta = told.fleet.snapshot("beta", NOW).vehicles
    assert (alpha.horizon, alpha.trail) == (None, ())
    assert beta.horizon is not None
    assert beta.horizon.points[0].grade_pct == 2.0
    assert len(beta.trail) == 1
    assert [each.horizon for each in told.fleet.snapshot(None, NOW).vehicles] == [None, None]


def test_a_reader_gets_the_newest_horizon_of_a_vehicle_when_it_selects_it() -> None:
    told = Told(alpha=pose(0), beta=pose(0))
    told.hear(alpha=horizon(0, 1.0), beta=horizon(0, 2.0))
    assert [each.horizon for each in told.news().vehicles] == [None, None]
    told.hear(beta=horizon(1, 2.5))
    assert told.read() is None
    selected = told.select("beta")
    assert selected is not None
    assert selected.horizon is not None
    assert selected.horizon.points[0].grade_pct == 2.5
    assert selected.trail_restart
    told.hear(alpha=horizon(1, 1.5))
    told.hear(beta=horizon(2, 3.0))
    changes = told.vehicles()
    assert changes.keys() == {"beta"}
    assert changes["beta"].horizon is not None
    assert changes["beta"].horizon.points[0].grade_pct == 3.0


def test_a_vehicle_that_is_no_longer_selected_is_told_only_where_it_is() -> None:
    told = Told(alpha=pose(0))
    told.select("alpha")
    told.cursor.select(None)
    assert told.news().selected is None
    told.hear(alpha=horizon(0, 1.0))
    assert told.read() is None
    told.hear(alpha=pose(1))
    alpha = told.vehicles()["alpha"]
    assert alpha.pose is not None
    assert (alpha.horizon, alpha.trail) == (None, ())


def test_a_selected_vehicle_may_be_heard_later() -> None:
    told = Told()
    told.cursor.select("alpha")
    assert (told.news().selected, told.read()) == ("alpha", None)
    told.hear(alpha=horizon(0, 1.0))
    assert told.vehicles()["alpha"].horizon is not None


def test_a_vehicle_is_listed_before_it_has_a_pose() -> None:
    told = Told()
    told.read()
    told.hear(alpha=FusionStatus(t_ns=NOW_NS))
    alpha = told.vehicles()["alpha"]
    assert (alpha.pose, alpha.status) == (None, None)


def test_a_forgotten_vehicle_is_gone_and_comes_back_whole_when_it_is_heard_again() -> None:
    told = Told(alpha=pose(50), beta=pose(0))
    told.select("alpha")
    told.fleet.forget("alpha")
    assert (told.news().gone, told.read()) == (("alpha",), None)
    assert [each.vehicle_id for each in told.fleet.snapshot(None, NOW).vehicles] == ["beta"]
    told.hear(alpha=horizon(0, 1.0))
    told.hear(alpha=pose(0))
    view = told.news()
    [alpha] = view.vehicles
    assert view.gone == ()
    assert alpha.pose is not None
    assert alpha.pose.lat_deg == pose(0).lat_deg
    assert alpha.horizon is not None
    assert len(alpha.trail) == 1


def test_a_vehicle_that_went_and_came_between_two_looks_is_both() -> None:
    told = Told(alpha=pose(0))
    told.select("alpha")
    told.fleet.forget("alpha")
    told.hear(alpha=pose(1))
    view = told.news()
    assert (view.gone, [each.vehicle_id for each in view.vehicles]) == (("alpha",), ["alpha"])


def test_a_vehicle_that_goes_again_is_gone_again() -> None:
    told = Told(alpha=pose(0), beta=pose(0))
    told.fleet.forget("alpha")
    told.fleet.forget("beta")
    told.hear(alpha=pose(1))
    told.read()
    told.fleet.forget("alpha")
    assert told.news().gone == ("alpha",)


def test_a_reader_that_comes_later_hears_nothing_of_the_gone() -> None:
    told = Told(alpha=pose(0))
    told.fleet.forget("alpha")
    assert (told.news().gone, told.read()) == ((), None)
    told.fleet.forget("never-heard")
    assert told.read() is None


def test_a_reader_that_missed_more_goings_than_are_remembered_begins_anew() -> None:
    told = Told(alpha=pose(0), omega=pose(0))
    told.select("omega")
    told.fleet.forget("alpha")
    for number in range(GONE_MAX):
        told.hear(**{f"bus-{number}": pose(0)})
        told.fleet.forget(f"bus-{number}")
    view = told.news()
    assert (view.kind, view.gone, len(view.vehicles)) == ("snapshot", (), 1)
    assert len(view.vehicles[0].trail) == 1
    assert told.read() is None


def test_a_service_that_goes_down_brings_no_forgotten_vehicle_back() -> None:
    told = Told(alpha=pose(0))
    told.fleet.forget("alpha")
    told.fleet.put_service("alpha", "fusion", up=False)
    assert told.news().vehicles == ()


def test_only_a_new_pose_says_when_the_vehicle_was_heard() -> None:
    told = Told()
    told.cursor.select("alpha")
    told.fleet.put("alpha", pose(0), "fusion", Receipt(0, age_ns=5_000_000_000))
    assert told.vehicles()["alpha"].heard == "2023-11-14T22:13:15.000Z"
    told.fleet.put_service("alpha", "eta", up=True)
    assert told.vehicles()["alpha"].heard is None
