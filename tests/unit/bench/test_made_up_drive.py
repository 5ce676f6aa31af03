"""The made-up drive is one that fusion follows, and the yardstick beside it filters."""

from collections import Counter
from itertools import islice

import msgspec

from wayline.inputs import Tick
from wayline.messages import FusionStatus, GpsFix, Gyro, Odometer, Pose
from wayline.tuning import Tuning
from wayline_bench.bare_filter import BareFilter
from wayline_bench.fusion import BETWEEN_NS, START_NS, STEP_INPUTS
from wayline_bench.made_up_drive import FIX_LATE_NS, drive, with_ticks
from wayline_fusion.core import FusionCore


def first(count: int, odometer_phase_ns: int) -> list[msgspec.Struct]:
    """The drive's first inputs, without its fixes."""
    inputs = with_ticks(drive(START_NS, odometer_phase_ns))
    return list(islice((each for each in inputs if not isinstance(each, GpsFix)), count))


def test_a_step_is_ten_gyro_samples_a_wheel_speed_and_a_tick() -> None:
    """Wherever in the step the odometer speaks, so that costs are told by the step."""
    for phase_ns in (0, BETWEEN_NS):
        kinds = Counter(type(each) for each in first(100 * STEP_INPUTS, phase_ns))
        assert kinds == {Gyro: 1000, Odometer: 100, Tick: 100}


def test_fixes_come_late() -> None:
    """As of a receiver, so that their price contains the rewinding."""
    newest_ns = 0
    for each in islice(drive(START_NS, BETWEEN_NS), 1000):
        newest_ns = max(newest_ns, each.t_ns)
        if isinstance(each, GpsFix):
            assert each.t_ns == newest_ns - FIX_LATE_NS


def test_fusion_follows_the_drive() -> None:
    """A pose a step, and placed; a core that rejects everything would be measured in vain."""
    core = FusionCore(Tuning())
    inputs = list(islice(with_ticks(drive(START_NS, BETWEEN_NS)), 6_000))
    outputs = [out for each in inputs for out in core.handle(each, "bench")]
    poses = [each for each in outputs if isinstance(each, Pose)]
    assert len(poses) == sum(isinstance(each, Tick) for each in inputs)
    assert poses[-1].mode == "fused"
    (*_, status) = (each for each in outputs if isinstance(each, FusionStatus))
    assert status.rejected <= 3


def test_the_yardstick_filters() -> None:
    """Its state goes where it is measured."""
    bare = BareFilter()
    bare.steps(200, 1)
    assert abs(bare.measured - 0.5) < 0.05
