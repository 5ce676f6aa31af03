"""The made-up fleet is one that eta follows and slope-map places."""

from collections import Counter

import pytest

from wayline.geo import step_between
from wayline.messages import Arrivals, GpsFix, Horizon, Message, Pose, Progress
from wayline.node import Node
from wayline.tuning import Tuning
from wayline_bench.fleet_vehicle import ROUTE_ID, SPEED_MPS, STOPS, Vehicle, ring
from wayline_eta.core import eta_node
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.known_roads import KnownRoads

START_NS = 1_800_000_000_000_000_000
SECOND_NS = 1_000_000_000


def heard_by(node: Node, start_m: float, seconds: int) -> list[Message]:
    """What a service says of a vehicle of which it hears everything that it reads."""
    vehicle = Vehicle(ring(), start_m, START_NS)
    outputs: list[Message] = []
    for second in range(seconds):
        for source, message in vehicle.say(START_NS + second * SECOND_NS):
            if type(message) in node.core.reads:
                outputs += node.take(message, source)
    return outputs


@pytest.mark.parametrize("start_m", [0.0, 3000.0, ring().length_m - 20.0])
def test_eta_follows_a_vehicle_from_its_second_pose_on(start_m: float) -> None:
    outputs = heard_by(eta_node([ring()], Tuning()), start_m, 30)
    progress = [each for each in outputs if isinstance(each, Progress)]
    arrivals = [each for each in outputs if isinstance(each, Arrivals)]
    assert len(progress) >= 29
    assert len(arrivals) >= 29
    assert all(each.on_route and abs(each.cross_track_m) < 1.0 for each in progress)
    assert len(arrivals[-1].stops) == STOPS


def test_slope_map_places_a_vehicle() -> None:
    route = ring()
    roads = KnownRoads()
    roads.follow(route.line, route.route_id, loop=True, bin_m=Tuning().map_bin_m)
    core = SlopeMapCore(roads, Tuning(), "fleet-0")
    outputs = heard_by(Node("slope-map", core), 500.0, 30)
    horizons = [each for each in outputs if isinstance(each, Horizon)][-28:]
    assert [each.road_id for each in horizons] == [ROUTE_ID] * 28
    # a tick comes with the pose after it
    assert horizons[-1].position_m == pytest.approx(500.0 + 28.0 * SPEED_MPS, abs=2.0)


def test_a_vehicle_goes_on_at_its_speed_over_the_end_of_the_road() -> None:
    route = ring()
    vehicle = Vehicle(route, route.length_m - 5.0, START_NS)
    said = [
        each.message for second in (0, 1) for each in vehicle.say(START_NS + second * SECOND_NS)
    ]
    (before, after) = (each for each in said if isinstance(each, GpsFix))
    places = [(fix.lat_deg or 0.0, fix.lon_deg or 0.0) for fix in (before, after)]
    assert step_between(*places[0], *places[1]).distance_m == pytest.approx(SPEED_MPS, abs=0.3)


def test_a_second_is_a_fix_a_pose_a_status_and_two_healths() -> None:
    """Of a vehicle of 10 Hz the other nine instants are poses alone."""
    vehicle = Vehicle(ring(), 0.0, START_NS)
    whole = Counter(each.message.topic for each in vehicle.say(START_NS))
    assert whole == {"gps_fix": 1, "pose": 1, "fusion_status": 1, "health": 2}
    assert [type(each.message) for each in vehicle.say(START_NS, pose_only=True)] == [Pose]
