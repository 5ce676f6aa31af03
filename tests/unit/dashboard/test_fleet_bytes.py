"""What a page costs that looks at a fleet of 500 in which one vehicle is selected."""

import msgspec
import pytest

from browser.shuttle import SECOND_NS, Shuttle
from wayline.messages import Message
from wayline.view import Receipt
from wayline_dashboard.fleet import Cursor, Fleet
from wayline_dashboard.instant import Instant
from wayline_dashboard.trail import POINTS_MAX
from wayline_dashboard.view import FleetView

VEHICLES = 500
START_NS = 1_700_000_000_000_000_000
NOW = Instant(START_NS, 0)
OWN_SERVICES = ("gps-ingest", "can-ingest", "fusion")
SELECTED = "bus-250"


class Depot:
    """Buses that all drive as one does."""

    def __init__(self) -> None:
        self.fleet, self.cursor = Fleet(), Cursor(selected=SELECTED)
        self.shuttle = Shuttle(START_NS)

    def drive(self, seconds: range) -> None:
        """Every bus, and every message of its bus topics once a second."""
        for second in seconds:
            told = [message for message, _ in self.shuttle.messages(second * 10)]
            health = self.shuttle.health(START_NS + second * SECOND_NS)
            told += [message for message, source in health if source in OWN_SERVICES]
            for number in range(VEHICLES):
                self.put(f"bus-{number}", told)

    def put(self, vehicle_id: str, messages: list[Message]) -> None:
        for message in messages:
            self.fleet.put(vehicle_id, message, "test", Receipt(0))

    def read(self) -> FleetView:
        view = self.fleet.read(self.cursor, NOW)
        assert view is not None
        return view


@pytest.fixture
def depot() -> Depot:
    """Heard for ten seconds; the selected bus has driven as far as its trail goes."""
    made = Depot()
    poses = [next(made.shuttle.messages(step))[0] for step in range(0, 6 * POINTS_MAX + 60, 6)]
    made.put(SELECTED, poses)
    made.shuttle.start_ns += 600 * POINTS_MAX * SECOND_NS
    made.drive(range(10))
    return made


def size(struct: msgspec.Struct) -> int:
    return len(msgspec.json.encode(struct))


def test_a_bus_more_costs_a_page_its_place_and_no_more(depot: Depot) -> None:
    first = depot.read()
    depot.drive(range(10, 11))
    second = depot.read()
    for view in (first, second):
        assert len(view.vehicles) == VEHICLES
        assert max(size(each) for each in view.vehicles if each.vehicle_id != SELECTED) < 500
        assert [each.vehicle_id for each in view.vehicles if each.horizon] == [SELECTED]
        assert [each.vehicle_id for each in view.vehicles if each.trail] == [SELECTED]
    # measured: 361 kB, of which 120 kB are the selected bus's trail of 2,000 points
    assert len(next(each.trail for each in first.vehicles if each.trail)) == POINTS_MAX
    assert size(first) < 400_000
    assert size(second) < 250_000  # measured: 243 kB


def test_a_page_without_a_pose_of_its_own_is_not_woken_by_the_rest_of_the_fleet(
    depot: Depot,
) -> None:
    depot.read()
    messages = [message for message, _ in depot.shuttle.messages(110)][1:]
    for number in range(VEHICLES):
        if f"bus-{number}" != SELECTED:
            depot.put(f"bus-{number}", messages)
    assert depot.fleet.read(depot.cursor, NOW) is None
