"""`bench fusion`: what fusion's core costs beside bare filterpy, and live beside bare Zenoh."""

from collections.abc import Iterable
from functools import partial
from itertools import islice, takewhile

import msgspec

from wayline.messages import GpsFix
from wayline.node import Node
from wayline.tuning import Tuning
from wayline_bench.aiding import aiding_row
from wayline_bench.bare_filter import AlgebraAlone, BareFilter
from wayline_bench.fusion_live import live_rows
from wayline_bench.made_up_drive import drive, with_ticks
from wayline_bench.rounds import Say, Work, cpu_s, in_turns
from wayline_bench.row import Row, compared
from wayline_fusion.core import FusionCore

START_NS = 1_750_000_000_000_000_000
BETWEEN_NS = 40_000_000
"""Nobody tells an odometer where the grid of poses is."""
ROUNDS = 15
STEPS = 1000
"""Of a round."""
STEP_INPUTS = 12
"""Ten gyro samples, a wheel speed, a tick."""
WARM_UP_STEPS = 300
"""Position and heading are known, the gyro's bias is being learned."""
STEP_BAR = 1.5
HOUR_NS = 3_600_000_000_000
HOUR_BAR_S = 30.0
UNIT = "us a step"


def bench(say: Say) -> list[Row]:
    """Every row; needs no recorded data."""
    return [*step_rows(say), aiding_row(say, START_NS), hour_row(say), *live_rows(say)]


def step_rows(say: Say) -> list[Row]:
    """A tenth of a second of sensors, messages in to messages out."""
    bare = BareFilter()
    works: dict[str, Work] = {
        "one": partial(bare.steps, STEPS, 1),
        "two": partial(bare.steps, STEPS, 2),
        "algebra": partial(AlgebraAlone().steps, STEPS),
        "between": Driven(BETWEEN_NS, fixes=False).steps,
        "on grid": Driven(0, fixes=False).steps,
        "fixes": Driven(BETWEEN_NS, fixes=True).steps,
    }
    spent_s = in_turns(works, ROUNDS, lambda progress: say(f"steps: {progress}"))
    us = {work: [each * 1e6 / STEPS for each in rounds] for work, rounds in spent_s.items()}
    names = {"one": "filterpy predict, update", "two": "filterpy predict, 2 updates"}

    def row(what: str, ours: str, yardstick: str, bar: float | None = None) -> Row:
        return compared(what, us[ours], us[yardstick], names[yardstick], unit=UNIT, bar=bar)

    step = "10 gyro, 1 odometer, tick to pose"
    return [
        row(step, "between", "one", STEP_BAR),
        row(step, "between", "two"),
        row(f"{step}, odometer on the grid", "on grid", "one", STEP_BAR),
        row(f"{step}, odometer on the grid", "on grid", "two"),
        row(f"{step}, a late fix every tenth step", "fixes", "one"),
        row("a step's algebra alone", "algebra", "one"),
    ]


class Driven:
    """A core on a made-up drive, whose messages are made beforehand."""

    def __init__(self, odometer_phase_ns: int, *, fixes: bool) -> None:
        self._core = FusionCore(Tuning())
        inputs = with_ticks(drive(START_NS, odometer_phase_ns))
        _give(self._core, islice(inputs, WARM_UP_STEPS * STEP_INPUTS))
        kept = (each for each in inputs if fixes or not isinstance(each, GpsFix))
        size = STEPS * STEP_INPUTS + (STEPS // 10 if fixes else 0)
        self._rounds = iter([list(islice(kept, size)) for _ in range(ROUNDS + 1)])

    def steps(self) -> None:
        """The next round."""
        _give(self._core, next(self._rounds))


def _give(core: FusionCore, inputs: Iterable[msgspec.Struct]) -> None:
    for each in inputs:
        core.handle(each, "bench")


def hour_row(say: Say) -> Row:
    """An hour of all sensors through the core as a replay runs it."""
    say("an hour of driving")
    end_ns = START_NS + HOUR_NS
    node = Node("fusion", FusionCore(Tuning()))
    inputs = list(takewhile(lambda each: each.t_ns < end_ns, drive(START_NS, BETWEEN_NS)))

    def through() -> None:
        for each in inputs:
            for _ in node.take(each, "bench"):
                pass

    name = "an hour of 100 Hz gyro, 10 Hz odometer, 1 Hz fixes"
    return compared(name, [cpu_s(through)], [HOUR_BAR_S], "allowed", unit="s", bar=1.0)
