"""What holds of fusion whatever arrives, in whatever order, as long as it is a message."""

import copy
import itertools
import math
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from builders import at, only
from unit.fusion.drives import Sensors, circle, messages_of, stop_and_go, town, truth_of
from wayline.codec import decode, encode
from wayline.messages import Barometer, FusionStatus, GpsFix, Gyro, Message, Odometer, Pose
from wayline.node import Node
from wayline.tuning import Tuning
from wayline_fusion.architectures.loose import Loose
from wayline_fusion.core import FusionCore

WARM_S = 40.0
START_S = 100.0
MODES = {"starting", "gps", "fused", "dead_reckoning", "lost"}

some = st.floats(allow_nan=False, allow_infinity=False)
"""Any number that JSON can carry."""
positive = st.floats(1e-300, 1e300)
ordinary = st.floats(0.0, 40.0)


def maybe(values: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.none() | values


fixes = st.builds(
    GpsFix,
    t_ns=st.just(0),
    valid=st.booleans(),
    lat_deg=maybe(st.floats(-90.0, 90.0) | st.floats(55.99, 56.01)),
    lon_deg=maybe(st.floats(-180.0, 180.0) | st.floats(9.99, 10.01)),
    alt_m=maybe(some),
    speed_mps=maybe(positive | ordinary),
    course_deg=maybe(st.floats(0.0, 360.0, exclude_max=True)),
    satellites=maybe(st.integers(0, 10**9)),
    hdop=maybe(positive | ordinary),
    pdop=maybe(positive | ordinary),
    h_std_m=maybe(positive),
    v_std_m=maybe(positive),
    speed_std_mps=maybe(positive),
    course_std_deg=maybe(positive),
)
wheels = st.builds(
    Odometer,
    t_ns=st.just(0),
    speed_mps=maybe(positive | ordinary | st.just(0.0)),
    reverse=maybe(st.booleans()),
)
gyros = st.builds(Gyro, t_ns=st.just(0), yaw_rate_degps=maybe(some | st.floats(-50.0, 50.0)))
barometers = st.builds(Barometer, t_ns=st.just(0), pressure_pa=maybe(positive))
anything = st.lists(
    st.tuples(st.floats(-1.5, 3.0) | st.just(0.0), fixes | wheels | gyros | barometers),
    min_size=1,
    max_size=40,
)


def timed(drawn: Sequence[tuple[float, Message]]) -> Iterator[Message]:
    """Each so much after the one before it."""
    seconds = START_S
    for step_s, message in drawn:
        seconds += step_s
        yield msgspec.structs.replace(message, t_ns=at(seconds))


def given_to(node: Node, messages: Sequence[Message]) -> list[Message]:
    return [output for message in messages for output in node.take(message, "test")]


def numbers_of(message: msgspec.Struct) -> Iterator[float]:
    for value in msgspec.structs.asdict(message).values():
        if isinstance(value, float):
            yield value
        elif isinstance(value, tuple):
            for each in value:
                yield from numbers_of(each)


@cache
def warm() -> Node:
    """After 40 s of ordinary driving, so that every state is known when the rubbish comes."""
    node = Node("fusion", FusionCore(Tuning()))
    drive = messages_of(town, truth_of(town, WARM_S), Sensors(0.5, gps_noise_m=1.0))
    ends_ns = round((START_S - WARM_S) * 1e9)
    given_to(node, [msgspec.structs.replace(m, t_ns=m.t_ns + ends_ns) for m in drive])
    return node


@settings(
    deadline=None,
    derandomize=True,
    max_examples=100,
    phases=(Phase.generate,),
    report_multiple_bugs=False,
)
@given(drawn=anything, is_warm=st.booleans())
def test_whatever_arrives_numbers_stay_numbers(
    drawn: Sequence[tuple[float, Message]], is_warm: bool
) -> None:
    """No exception; what is published can be sent and read; distance and time only grow."""
    node = copy.deepcopy(warm()) if is_warm else Node("fusion", FusionCore(Tuning()))
    outputs = given_to(node, list(timed(drawn)))
    for message in outputs:
        assert all(math.isfinite(number) for number in numbers_of(message)), message
        assert decode(message.topic, encode(message)) == message
    poses = only(outputs, Pose)
    assert {pose.mode for pose in poses} <= MODES
    assert (np.diff([pose.t_ns for pose in poses]) > 0).all()
    assert (np.diff([pose.distance_m for pose in poses]) >= 0.0).all()
    assert_covariance(node)


def assert_covariance(node: Node) -> None:
    """Symmetric and positive semi-definite, but for rounding."""
    assert isinstance(node.core, FusionCore)
    assert isinstance(node.core._estimator, Loose)
    P = node.core._estimator.filter.P  # noqa: N806 - the letter of the papers
    stds = np.sqrt(np.diag(P))
    assert np.isfinite(P).all()
    correlations = P / np.outer(stds, stds).clip(min=1e-300)
    assert np.abs(correlations - correlations.T).max() < 1e-6
    assert np.linalg.eigvalsh(0.5 * (correlations + correlations.T)).min() > -1e-6


def test_a_copy_goes_on_exactly_as_the_original() -> None:
    """From driving to rest and off again; and apart from it: nothing of its arrays is shared."""
    drive = list(messages_of(stop_and_go, truth_of(stop_and_go, 60.0), Sensors(0.5)))
    split = next(place for place, message in enumerate(drive) if message.t_ns >= at(35.0))
    original = Node("fusion", FusionCore(Tuning()))
    given_to(original, drive[:split])
    first, second = copy.deepcopy(original), copy.deepcopy(original)
    ahead = given_to(first, drive[split:])
    turns = [(given_to(original, [m]), given_to(second, [m])) for m in drive[split:]]
    assert len(only(ahead, Pose)) > 240
    assert [output for outputs, _ in turns for output in outputs] == ahead
    assert [output for _, outputs in turns for output in outputs] == ahead


@cache
def on_a_circle() -> tuple[Node, list[Message]]:
    """A node that knows its sensors, and the next seconds of its drive."""
    node = Node("fusion", FusionCore(Tuning()))
    exact = messages_of(circle, truth_of(circle, WARM_S + 6.2), Sensors(gps_noise_m=1.0))
    # measurements of one instant are taken in as they come, so each sensor has its own
    offsets_ns: dict[type[Message], int] = {GpsFix: 3_000_000, Odometer: 7_000_000}
    moved = [msgspec.structs.replace(m, t_ns=m.t_ns + offsets_ns.get(type(m), 0)) for m in exact]
    drive = sorted(moved, key=lambda message: message.t_ns)
    split = next(place for place, message in enumerate(drive) if message.t_ns >= at(WARM_S))
    given_to(node, drive[:split])
    return node, drive[split:]


def last_state(messages: Sequence[Message]) -> list[float]:
    outputs = given_to(copy.deepcopy(on_a_circle()[0]), messages)
    status = msgspec.structs.replace(only(outputs, FusionStatus)[-1], verdicts=(), rejected=0)
    return [*numbers_of(only(outputs, Pose)[-1]), *numbers_of(status)]


@settings(deadline=None, derandomize=True, max_examples=30)
@given(delays_s=st.lists(st.floats(0.0, 0.99), min_size=75, max_size=75))
def test_any_order_of_late_messages_ends_in_the_same_state(delays_s: list[float]) -> None:
    """Fixes and wheel speeds, each up to a second late on its own way."""
    ordered = on_a_circle()[1]
    ways = itertools.cycle(delays_s)

    def arrival_ns(message: Message) -> float:
        prompt = isinstance(message, Gyro) or message.t_ns > at(WARM_S + 4.9)
        return message.t_ns + (0.0 if prompt else next(ways) * 1e9)

    late = sorted(ordered, key=arrival_ns)
    assert last_state(late) == pytest.approx(last_state(ordered), abs=1e-6)
