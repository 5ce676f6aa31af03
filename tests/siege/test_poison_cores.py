"""Any messages within the bounds, in any order, leave every core and view at work."""

from collections.abc import Iterator

import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from besieged import street_pose
from lasting import examples
from poison import NOW_NS, messages
from street import street_fix, write_route
from wayline.codec import encode
from wayline.database import open_database
from wayline.messages import MESSAGES, Message
from wayline.node import Node
from wayline.route import Route
from wayline.route_file import load_route
from wayline.tuning import Tuning
from wayline.view import Receipt
from wayline_dashboard.live_view import LiveView
from wayline_eta.board import EtaBoard
from wayline_eta.core import make_eta_core
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.store import SlopeStore

VEHICLE = "bus-7"
SOME = st.lists(
    st.sampled_from([message.topic for message in MESSAGES]).flatmap(messages), max_size=12
)
WITHIN_A_DRIVE = st.lists(
    st.tuples(
        st.integers(0, 89),
        st.sampled_from(["pose", "gps_fix", "barometer"]).flatmap(messages),
        st.booleans(),
    ),
    max_size=12,
)
"""Seconds of a drive at which something else is said, and whether at the drive's own time."""
WHOLE = settings(
    max_examples=examples(15),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


@pytest.fixture(scope="module")
def route(tmp_path_factory: pytest.TempPathFactory) -> Route:
    return load_route(write_route(tmp_path_factory.mktemp("route") / "street.geojson"))


def driven(instead: list[tuple[int, Message, bool]]) -> list[Message]:
    """A minute and a half along the street, with what else is said within."""
    said: list[Message] = []
    for second in range(90):
        fix = street_fix(NOW_NS, second)
        pose = street_pose(fix.t_ns, 10.0 * second)
        said += [fix, pose]
        for at, message, on_time in instead:
            if at == second:
                said.append(replace(message, t_ns=fix.t_ns) if on_time else message)
    return said


def published(node: Node, heard: list[Message]) -> Iterator[Message]:
    for message in heard:
        if type(message) in node.core.reads:
            yield from node.take(message, "test")
    yield from node.finish(heard[-1].t_ns if heard else 0)


@WHOLE
@given(instead=WITHIN_A_DRIVE)
def test_eta_answers_for_all_vehicles_whatever_one_says(
    route: Route, instead: list[tuple[int, Message, bool]]
) -> None:
    heard = driven(instead)
    board = EtaBoard()
    node = Node("eta", make_eta_core([route], Tuning()))
    for message in [*heard, *published(node, heard)]:
        encode(message)
        board.put(VEHICLE, message, "test", Receipt(0))
    msgspec.json.encode(board.vehicles())


@WHOLE
@given(heard=SOME)
def test_the_page_is_told_of_all_vehicles_whatever_one_says(heard: list[Message]) -> None:
    live = LiveView()
    for message in heard:
        live.put(VEHICLE, message, "test", Receipt(0))
    if any(type(message) in live.reads for message in heard):
        msgspec.json.encode(live.snapshot(VEHICLE))


@WHOLE
@given(instead=WITHIN_A_DRIVE)
def test_the_map_goes_on_learning_whatever_one_vehicle_says(
    route: Route, instead: list[tuple[int, Message, bool]]
) -> None:
    roads = KnownRoads([])
    roads.follow(route.line, route.route_id, loop=False, bin_m=20.0)
    store = SlopeStore(open_database("sqlite://", "wayline_slope_map"))
    node = Node("slope-map", SlopeMapCore(roads, Tuning(), VEHICLE), store)
    for message in published(node, driven(instead)):
        encode(message)
