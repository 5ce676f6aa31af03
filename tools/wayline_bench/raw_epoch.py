"""What an epoch of raw measurements costs in fusion's core, beside bare filterpy."""

from collections.abc import Iterator
from functools import partial

from wayline.messages import GpsRaw, Message
from wayline.tuning import Tuning
from wayline_bench.bare_filter import BareFilter
from wayline_bench.made_up_drive import drive
from wayline_bench.made_up_ranges import SATELLITES, with_ranges
from wayline_bench.rounds import Say, cpu_s
from wayline_bench.row import Row, compared
from wayline_fusion.core import FusionCore
from wayline_fusion.filter.ranging import RANGING_SIZE

START_NS = 1_750_000_000_000_000_000
BETWEEN_NS = 40_000_000
WARM_UP = 60
"""Epochs; by then the heading is sure, and no fit is needed any more."""
ROUNDS = 9
EPOCHS = 40
"""Of a round."""
BAR = 1.0


def epoch_row(say: Say) -> Row:
    """Message in to status out; the vehicle's sensors between epochs are not counted."""
    inputs = with_ranges(drive(START_NS, BETWEEN_NS))
    core, bare = FusionCore(Tuning(architecture="measurement")), BareFilter(RANGING_SIZE)
    _spent_s(core, inputs, WARM_UP)
    ours_us, bare_us = [], []
    for number in range(ROUNDS):
        say(f"epochs: round {number} of {ROUNDS}")
        ours_us.append(_spent_s(core, inputs, EPOCHS) * 1e6 / EPOCHS)
        bare_us.append(cpu_s(partial(bare.steps, EPOCHS * SATELLITES, 1)) * 1e6 / EPOCHS)
    return compared(
        f"an epoch of {SATELLITES} satellites, ranges and range rates, to fusion's status",
        ours_us,
        bare_us,
        f"filterpy, {SATELLITES} times predict, update",
        unit="us an epoch",
        bar=BAR,
    )


def _spent_s(core: FusionCore, inputs: Iterator[Message], epochs: int) -> float:
    """On so many epochs."""
    spent_s, left = 0.0, epochs
    for each in inputs:
        if isinstance(each, GpsRaw):
            spent_s += cpu_s(partial(core.handle, each, "bench"))
            left -= 1
        else:
            core.handle(each, "bench")
        if not left:
            break
    return spent_s
