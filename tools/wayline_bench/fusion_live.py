"""A live fusion: how late its poses are, beside a bare echo of the same sizes and rates."""

import contextlib
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import numpy as np
import zenoh

from wayline.bus import Subscription, open_session
from wayline.codec import decode, encode
from wayline.messages import Gyro, Health, Pose
from wayline.tuning import Tuning
from wayline_bench import echo
from wayline_bench.drive_feeder import VEHICLE, DriveFeed, Fed, feed
from wayline_bench.made_up_drive import drive, with_ticks
from wayline_bench.rounds import Say
from wayline_bench.row import Row, compared
from wayline_cli.local_system import LocalSystem
from wayline_fusion.core import FusionCore

SERVICE = "fusion"
START_S = 20.0
WARM_UP_S = 10.0
"""Until poses have all their fields."""
LENGTH_S = 60.0
POLL_S = 0.05
BAR = 3.0


@dataclass(frozen=True)
class Ears:
    """What was heard when (monotonic clock); decoded when all is over."""

    messages: list[tuple[str, bytes, float]] = field(default_factory=list)
    """Key and payload."""
    answers: list[tuple[bytes, float]] = field(default_factory=list)

    def on_message(self, key: str, payload: bytes) -> None:
        """Fusion said something."""
        self.messages.append((key, payload, time.monotonic()))

    def on_answer(self, sample: zenoh.Sample) -> None:
        """The echo came back."""
        self.answers.append((sample.payload.to_bytes(), time.monotonic()))

    def is_heard(self, topic: str) -> bool:
        """Whether anything of a topic came."""
        return any(key.split("/")[3] == topic for key, _, _ in self.messages)

    def poses(self) -> dict[int, float]:
        """When each pose came, by its instant."""
        return {
            decode(Pose.topic, payload).t_ns: at_s
            for key, payload, at_s in self.messages
            if key.split("/")[3] == Pose.topic
        }


def live_rows(say: Say) -> list[Row]:
    """A minute of a vehicle's sensors."""
    say(f"live: {WARM_UP_S + LENGTH_S:g} s")
    ears = Ears()
    fed = _run(ears)
    poses = ears.poses()
    answers = {int(payload): at_s for payload, at_s in ears.answers}
    ours_ms = _delays_ms(fed.pose_due_s, poses)
    echo_ms = _delays_ms(fed.echo_sent_s, answers)
    due = [float(len(fed.pose_due_s))]
    return [
        _latency(ours_ms, echo_ms, 50, None),
        _latency(ours_ms, echo_ms, 99, BAR),
        compared("live: poses heard", [float(len(ours_ms))], due, "due"),
    ]


def _delays_ms(sent_s: dict[int, float], heard_s: dict[int, float]) -> list[float]:
    return [1e3 * (heard_s[each] - at_s) for each, at_s in sent_s.items() if each in heard_s]


def _latency(
    ours_ms: Sequence[float], echo_ms: Sequence[float], percent: int, bar: float | None
) -> Row:
    ours, bare = (float(np.percentile(each, percent)) for each in (ours_ms, echo_ms))
    name = f"live: sensor message to pose, p{percent}"
    return compared(name, [ours], [bare], "bare Zenoh echo", unit="ms", bar=bar)


def _run(ears: Ears) -> Fed:
    """Run the processes and feed them. Raises TimeoutError where one does not start."""
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="wayline-bench-")))
        system = stack.enter_context(LocalSystem(folder, vehicle_id=VEHICLE))
        system.start_router()
        (endpoint,) = system.bus.connect
        system.start_command("echo", (sys.executable, "-m", echo.__name__, endpoint))
        system.await_said("echo", echo.READY, START_S)
        session = stack.enter_context(open_session(system.bus))
        topics = [Pose.topic, Health.topic]
        subscription = Subscription(session, [VEHICLE], topics, ears.on_message)
        stack.callback(subscription.close)
        answers = session.declare_subscriber(echo.ANSWER, ears.on_answer)
        stack.callback(answers.undeclare)
        system.start(SERVICE)
        _await_health(ears)
        size = len(encode(Gyro(t_ns=time.time_ns(), yaw_rate_degps=1.2345678901234567)))
        plan = DriveFeed(system.bus, LENGTH_S, WARM_UP_S, size, _pose_bytes())
        # not forked: Zenoh's threads would not come along
        spawn = multiprocessing.get_context("spawn")
        return stack.enter_context(ProcessPoolExecutor(1, spawn)).submit(feed, plan).result()


def _pose_bytes() -> int:
    """Size of a pose on the bus, warmed up."""
    core, inputs = FusionCore(Tuning()), with_ticks(drive(time.time_ns(), 0))
    outputs = (message for each in islice(inputs, 2_000) for message in core.handle(each, "bench"))
    return max(len(encode(message)) for message in outputs if isinstance(message, Pose))


def _await_health(ears: Ears) -> None:
    """A service that tells its health hears."""
    deadline_s = time.monotonic() + START_S
    while not ears.is_heard(Health.topic):
        if time.monotonic() > deadline_s:
            raise TimeoutError(f"{SERVICE} tells no health")
        time.sleep(POLL_S)
