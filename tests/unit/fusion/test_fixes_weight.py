"""How much a position counts: by what was learned of its receiver, and less where unlikely."""

import copy
from functools import cache

import numpy as np
import pytest

from builders import at, only
from faults import displaced
from unit.fusion.drives import ORIGIN, Sensors, messages_of, truth_of, winding
from wayline.likelihood import threshold
from wayline.messages import FusionStatus, Message, Pose, Verdict
from wayline.node import Node
from wayline.tuning import Tuning
from wayline_fusion.architectures.loose import Loose
from wayline_fusion.core import FusionCore

OFF_S = 120.0
LIKELY = threshold(2, 0.95)


def given_to(node: Node, messages: list[Message]) -> list[Message]:
    return [output for message in messages for output in node.take(message, "test")]


@cache
def before(gps_noise_m: float) -> tuple[Node, list[Message]]:
    """Two minutes of winding road, and the fix of then with a tenth of a second more."""
    sensors = Sensors(gps_noise_m=gps_noise_m)
    drive = list(messages_of(winding, truth_of(winding, OFF_S + 1.15), sensors))
    split = next(place for place, message in enumerate(drive) if message.t_ns >= at(OFF_S))
    node = Node("fusion", FusionCore(Tuning()))
    given_to(node, drive[:split])
    return node, drive[split:]


def north_m(off_m: float, gps_noise_m: float) -> tuple[float, Verdict]:
    """Where the vehicle seems to be after one fix so far off, and the gate's word on that fix."""
    node, rest = before(gps_noise_m)
    node = copy.deepcopy(node)
    faulty = displaced((OFF_S, OFF_S + 0.5), 0.0, off_m)(rest, at(0.0))
    outputs = given_to(node, faulty)
    pose = next(pose for pose in only(outputs, Pose) if pose.t_ns == at(OFF_S + 0.1))
    verdicts = [v for status in only(outputs, FusionStatus) for v in status.verdicts]
    (verdict,) = [v for v in verdicts if v.sensor == "gps_position" and v.t_ns == at(OFF_S)]
    return ORIGIN.to_plane(pose.lat_deg or 0.0, pose.lon_deg or 0.0)[1], verdict


def followed(off_m: float, gps_noise_m: float) -> tuple[float, Verdict]:
    """The share of a displacement that the pose follows, and the verdict."""
    there_m, verdict = north_m(off_m, gps_noise_m)
    return (there_m - north_m(0.0, gps_noise_m)[0]) / off_m, verdict


@pytest.mark.parametrize(("gps_noise_m", "unlikely_m"), [(0.1, 2.0), (0.5, 2.5), (1.0, 3.5)])
def test_an_unlikely_position_that_passes_the_gate_counts_for_less(
    gps_noise_m: float, unlikely_m: float
) -> None:
    """Where a likely one is followed by a share, of this one even the whole way is less."""
    likely, _ = followed(0.25, gps_noise_m)
    unlikely, verdict = followed(unlikely_m, gps_noise_m)
    assert verdict.accepted
    assert verdict.nis == pytest.approx(LIKELY)
    assert 0.0 < unlikely < 0.6 * likely


def test_among_likely_positions_all_count_alike() -> None:
    shares = [followed(off_m, 1.0) for off_m in (-0.5, 0.5, 1.0)]
    assert all(verdict.accepted and verdict.nis < LIKELY for _, verdict in shares)
    assert np.ptp([share for share, _ in shares]) < 0.01


def test_a_position_beyond_the_gate_counts_for_nothing() -> None:
    share, verdict = followed(20.0, 0.5)
    assert not verdict.accepted
    assert verdict.nis > verdict.threshold
    assert share == pytest.approx(0.0, abs=0.02)


def white_factor(gps_noise_m: float) -> float:
    """Of the claimed variance, as learned in two minutes."""
    core = before(gps_noise_m)[0].core
    assert isinstance(core, FusionCore)
    assert isinstance(core._estimator, Loose)
    return core._estimator.learned.position_noise.factor


def test_a_receivers_white_noise_is_learned_above_and_below_what_it_claims() -> None:
    """Of 2 m a tenth of the variance is white: 0.63 m."""
    claimed_m2 = 0.1 * Tuning().gps_position_std_floor_m ** 2
    assert white_factor(0.1) < 0.1
    assert white_factor(0.4) == pytest.approx(0.4**2 / claimed_m2, rel=0.5)
    assert white_factor(1.0) > 1.2


def test_fixes_of_a_quiet_receiver_count_for_more() -> None:
    assert followed(0.25, 0.1)[0] > 1.5 * followed(0.25, 1.0)[0]
