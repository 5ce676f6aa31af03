"""Plays a drive through real processes and compares what comes out with its replay.

`python -m wayline_cli.live_check DRIVE [--speed N]`, or `scripts/live-check`.
"""

import argparse
import sys
import tempfile
import time
import urllib.request
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.bus import open_session
from wayline.codec import decode
from wayline.drive import Drive
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.geo import step_between
from wayline.messages import Health, Message, Pose
from wayline_cli.listener import Heard, Listener
from wayline_cli.local_system import LocalSystem
from wayline_fusion.core import FusionCore
from wayline_replay.replay import replay

SENSED = ("gps_fix", "gps_sky", "gps_raw", "odometer", "gyro", "torque", "barometer")
NEAR_M = 0.5
START_S = 20.0
END_S = 30.0
FUSED = sorted(message.topic for message in FusionCore.reads)
Counts = dict[str, int]
Floats = NDArray[np.float64]
Say = Callable[[str], None]


class LiveReport(msgspec.Struct, frozen=True, kw_only=True):
    """What came of a drive played live, beside its replay."""

    elapsed_s: float
    published: Counts
    """Sensor messages by topic that a listener heard."""
    lost: Counts
    """Sensor messages of the replay that the listener did not hear, compared by their instants."""
    fusion_lost: Counts
    """Sensor messages of the replay that fusion did not hear; negative: it heard some twice."""
    dropped: int
    """What fusion itself counted as dropped."""
    poses: int
    missing_poses: int
    """Instants at which only the replay has a pose."""
    extra_poses: int
    """Instants during the drive at which only the live system has one."""
    near_share: float
    """Share of the replay's located poses that the live system has within NEAR_M."""
    largest_m: float
    lag_p50_ms: float
    lag_p99_ms: float
    """From hearing the first message at or past a pose's instant to hearing the pose."""

    @property
    def holds(self) -> bool:
        """No message lost, and 99 % of the poses where the replay has them."""
        none_lost = not (self.dropped or any(self.lost.values()) or any(self.fusion_lost.values()))
        return none_lost and self.near_share >= 0.99

    def __str__(self) -> str:
        return "\n".join(
            (
                f"played in {self.elapsed_s:.1f} s: {_counted(self.published)}",
                f"lost on the way to a listener: {_counted(self.lost)}",
                f"lost on the way to fusion: {_counted(self.fusion_lost)}, dropped {self.dropped}",
                f"poses: {self.poses}, missing {self.missing_poses}, extra {self.extra_poses}",
                f"within {NEAR_M} m of the replay: {100 * self.near_share:.3f} %,"
                f" largest difference {self.largest_m:.3f} m",
                f"lag of a pose: p50 {self.lag_p50_ms:.1f} ms, p99 {self.lag_p99_ms:.1f} ms",
            )
        )


def check_live(folder: Path, *, speed: float, say: Say = lambda _: None) -> LiveReport:
    """Play the drive in `folder` through ingest and fusion processes, and replay it.

    Raises InputError for the drive, TimeoutError where a process does not do its part.
    """
    drive = load_drive(folder)
    with tempfile.TemporaryDirectory(prefix="wayline-live-") as scratch:
        out = Path(scratch) / "replay"
        say("replaying")
        replay(folder, out)
        expected = {topic: _read(out, topic) for topic in (*SENSED, "pose")}
        with LocalSystem(Path(scratch), vehicle_id=drive.drive.vehicle_id) as system:
            say(f"playing live at {speed:g} times the speed")
            started_s = time.monotonic()
            listener, fusion_heard = _play(system, drive, folder, speed, expected["pose"][-1].t_ns)
            elapsed_s = time.monotonic() - started_s
    return compare(listener, expected, fusion_heard, elapsed_s)


def _play(
    system: LocalSystem, drive: Drive, folder: Path, speed: float, end_ns: int
) -> tuple[Listener, Counts]:
    """What a listener heard of the whole drive, and how much fusion did."""
    players = [
        *(["gps-ingest"] if drive.nmea or drive.avl or drive.raw else []),
        *(["can-ingest"] if drive.can else []),
    ]
    system.start_router()
    with open_session(system.bus) as session:
        listener = Listener(session, drive.drive.vehicle_id, (*SENSED, "pose", "health"))
        system.start("fusion")
        listener.await_alive("fusion", timeout_s=START_S)
        for player in players:
            system.start(player, "--drive", str(folder), "--speed", f"{speed:g}")
        timeout_s = START_S + END_S + _duration_s(end_ns, listener) / speed
        for player in players:
            listener.await_message("health", partial(_is_over, player), timeout_s=timeout_s)
        listener.await_message("pose", lambda h: h.message.t_ns >= end_ns, timeout_s=END_S)
        fusion_heard = messages_in(system.url("fusion"))
        listener.close()
    return listener, fusion_heard


def _duration_s(end_ns: int, listener: Listener) -> float:
    first = listener.await_message("gps_fix", timeout_s=START_S + END_S)
    return max((end_ns - first.message.t_ns) * 1e-9, 0.0)


def _is_over(player: str, heard: Heard) -> bool:
    message = heard.message
    if not isinstance(message, Health) or message.service != player:
        return False
    return message.detail is not None and "played to its end" in message.detail


def messages_in(url: str) -> Counts:
    """How many messages of each topic a service has heard, by its metrics."""
    with urllib.request.urlopen(f"{url}/metrics", timeout=END_S) as answer:  # noqa: S310 - http
        lines = answer.read().decode().splitlines()
    prefix = 'wayline_messages_in_total{topic="'
    pairs = [line.removeprefix(prefix).split('"} ') for line in lines if line.startswith(prefix)]
    return {topic: round(float(value)) for topic, value in pairs}


def compare(
    listener: Listener,
    expected: dict[str, list[Message]],
    fusion_heard: Counts,
    elapsed_s: float,
) -> LiveReport:
    """The report on what was heard, given the replay's messages by topic."""
    published = {topic: len(listener.heard(topic)) for topic in SENSED}
    last_ns = expected["pose"][-1].t_ns
    live = _poses(h.message for h in listener.heard("pose") if h.message.t_ns <= last_ns)
    replayed = _poses(expected["pose"])
    differences_m = _differences_m(replayed, live)
    lags_ms = _lags_ms(listener, last_ns)
    dropped = [h.message for h in listener.heard("health") if isinstance(h.message, Health)]
    return LiveReport(
        elapsed_s=elapsed_s,
        published=published,
        lost={
            topic: _lost(expected[topic], (h.message for h in listener.heard(topic)))
            for topic in SENSED
        },
        fusion_lost={topic: len(expected[topic]) - fusion_heard.get(topic, 0) for topic in FUSED},
        dropped=max((health.dropped for health in dropped), default=0),
        poses=len(live),
        missing_poses=len(replayed.keys() - live.keys()),
        extra_poses=len(live.keys() - replayed.keys()),
        near_share=float(np.mean(differences_m <= NEAR_M)),
        largest_m=float(np.max(differences_m[np.isfinite(differences_m)], initial=0.0)),
        lag_p50_ms=float(np.quantile(lags_ms, 0.5)),
        lag_p99_ms=float(np.quantile(lags_ms, 0.99)),
    )


def _lost(expected: Iterable[Message], heard: Iterable[Message]) -> int:
    missing = Counter(message.t_ns for message in expected)
    missing.subtract(message.t_ns for message in heard)
    return (+missing).total()


def _read(out: Path, topic: str) -> list[Message]:
    return [decode(topic, line) for line in (out / f"{topic}.jsonl").read_bytes().splitlines()]


def _poses(messages: Iterable[Message]) -> dict[int, Pose]:
    return {message.t_ns: message for message in messages if isinstance(message, Pose)}


def _differences_m(replayed: dict[int, Pose], live: dict[int, Pose]) -> Floats:
    """Distance at each of the replay's located poses; infinite where live has none."""
    return np.array(
        [
            _distance_m(pose, live.get(t_ns))
            for t_ns, pose in replayed.items()
            if pose.lat_deg is not None
        ]
    )


def _distance_m(one: Pose, other: Pose | None) -> float:
    if other is None or one.lat_deg is None or one.lon_deg is None:
        return np.inf
    if other.lat_deg is None or other.lon_deg is None:
        return np.inf
    return step_between(one.lat_deg, one.lon_deg, other.lat_deg, other.lon_deg).distance_m


def _lags_ms(listener: Listener, last_ns: int) -> Floats:
    """Milliseconds from the message that made a pose due to the pose, both as heard."""
    topics = ("gps_fix", "odometer", "gyro", "barometer")
    inputs = sorted(
        (heard.received_s, heard.message.t_ns)
        for topic in topics
        for heard in listener.heard(topic)
    )
    received_s = np.array([received for received, _ in inputs])
    reached_ns = np.maximum.accumulate(np.array([t_ns for _, t_ns in inputs], dtype=np.int64))
    poses = [h for h in listener.heard("pose") if h.message.t_ns <= min(last_ns, reached_ns[-1])]
    due = np.searchsorted(reached_ns, np.array([h.message.t_ns for h in poses], dtype=np.int64))
    lags_s: Floats = np.array([heard.received_s for heard in poses]) - received_s[due]
    return 1e3 * lags_s


def _counted(counts: Counts) -> str:
    return ", ".join(f"{topic} {count}" for topic, count in counts.items()) or "nothing"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command: prints the report; status 1 where it does not hold."""
    parser = argparse.ArgumentParser(prog="live-check", description=__doc__)
    parser.add_argument("drive", type=Path, metavar="DRIVE", help="a drive's folder")
    parser.add_argument("--speed", type=float, default=5.0, help="times as fast as driven")
    options = parser.parse_args(arguments)
    try:
        report = check_live(options.drive, speed=options.speed, say=print)
    except InputError as error:
        sys.stderr.write(f"live-check: {error}\n")
        sys.exit(2)
    print(report)
    sys.exit(0 if report.holds else 1)


if __name__ == "__main__":
    main()
