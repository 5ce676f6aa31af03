"""A gyro that becomes warmer under way is known less well."""

import msgspec

from builders import gyro, only, run_core
from unit.fusion.drives import Sensors, messages_of, seconds_of, straight, truth_of
from wayline.messages import FusionStatus, Gyro, Message
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.intake.warmth import Warmth


def bias_std_degps(warmth_c_per_s: float) -> float:
    """After five minutes with fixes and one without, while the gyro becomes warmer."""
    truths = truth_of(straight, 360.0)
    messages: list[Message] = []
    for message in messages_of(straight, truths, Sensors(outage=(300.0, 400.0))):
        if isinstance(message, Gyro):
            warm_c = 20.0 + warmth_c_per_s * max(seconds_of(message.t_ns) - 300.0, 0.0)
            message = msgspec.structs.replace(message, temperature_c=warm_c)  # noqa: PLW2901
        messages.append(message)
    status: FusionStatus = only(run_core(FusionCore(Tuning()), messages), FusionStatus)[-1]
    assert status.gyro_bias_std_degps is not None
    return status.gyro_bias_std_degps


def test_the_bias_is_doubted_by_what_warmth_does_to_it() -> None:
    assert bias_std_degps(0.2) > bias_std_degps(0.0) + 0.005


def test_a_sensor_that_flickers_between_two_steps_is_no_warmth() -> None:
    warmth = Warmth()
    flicker = [20.0 + second % 2 for second in range(600)]
    told = [
        warmth.change(
            msgspec.structs.replace(gyro(float(second), 0.0), temperature_c=temperature_c)
        )
        for second, temperature_c in enumerate(flicker)
    ]
    assert not any(told)
