"""A real drive over a restart of fusion: from run to run, and in the middle of a tunnel.

css-164 starts without GPS for two minutes; in town its OBD speed comes twice a second.
"""

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np

from builders import only
from unit.fusion.test_restart import Kept, std_m
from wayline.drive_file import load_drive
from wayline.geo import step_between
from wayline.messages import FusionStatus, Message, Pose
from wayline.node import Node
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.keeping.records import Saved
from wayline_replay.outages import Outage, with_outages
from wayline_replay.stream import DriveStream

SECOND_NS = 1_000_000_000
TUNNEL = Outage(600.0, 60.0)
STOP_S, START_S, END_S = 630.0, 632.0, 720.0


def driven(messages: Iterable[Message], saved: Saved | None = None) -> tuple[list[Message], Saved]:
    """What fusion publishes, and what it keeps at the end."""
    kept = Kept()
    node = Node("fusion", FusionCore(Tuning(), saved), kept)
    last_ns, published = 0, []
    for message in messages:
        last_ns = max(last_ns, message.t_ns)
        published += list(node.take(message, "test"))
    published += list(node.finish(last_ns))
    return published, kept.records[-1]


def with_tunnel(folder: Path) -> tuple[int, list[Message]]:
    """When the drive began, and its first twelve minutes."""
    stream = with_outages(DriveStream(load_drive(folder), str(folder)), [TUNNEL])
    messages = list(until(END_S, (received.message for received in stream)))
    return min(message.t_ns for message in messages[:1000]), messages


def until(end_s: float, messages: Iterable[Message]) -> Iterator[Message]:
    start_ns = 0
    for message in messages:
        start_ns = start_ns or message.t_ns
        if message.t_ns - start_ns > (end_s + 5.0) * SECOND_NS:
            return
        yield message


def test_css_164_restarted_in_a_tunnel_comes_out_where_it_is(
    recorded: Callable[[str], Path],
) -> None:
    """Half a minute into the tunnel fusion is stopped, and back after two seconds."""
    start_ns, messages = with_tunnel(recorded("css-164"))

    def within(from_s: float, to_s: float) -> list[Message]:
        bounds_ns = start_ns + from_s * SECOND_NS, start_ns + to_s * SECOND_NS
        return [message for message in messages if bounds_ns[0] <= message.t_ns < bounds_ns[1]]

    whole = {pose.t_ns: pose for pose in only(driven(messages)[0], Pose)}
    _, saved = driven(within(-60.0, STOP_S))
    outputs, _ = driven(within(START_S, END_S), saved)
    poses = only(outputs, Pose)
    seconds = np.array([(pose.t_ns - start_ns) * 1e-9 for pose in poses])
    apart_m = np.array([distance_m(pose, whole[pose.t_ns]) for pose in poses])
    inside = seconds < TUNNEL.start_s + TUNNEL.length_s
    modes = [pose.mode for pose in poses]
    assert {modes[k] for k in np.flatnonzero(inside)} == {"dead_reckoning"}
    assert all(apart_m[k] < 3.0 * std_m(poses[k]) for k in np.flatnonzero(inside))
    assert all(std_m(poses[k]) < 100.0 for k in np.flatnonzero(inside))
    out = seconds > TUNNEL.start_s + TUNNEL.length_s + 10.0
    assert {modes[k] for k in np.flatnonzero(out)} == {"fused"}
    assert apart_m[out].max() < 5.0
    assert {status.calibration for status in only(outputs, FusionStatus)} == {"calibrated"}


def distance_m(one: Pose, other: Pose) -> float:
    assert one.lat_deg is not None
    assert one.lon_deg is not None
    assert other.lat_deg is not None
    assert other.lon_deg is not None
    return step_between(one.lat_deg, one.lon_deg, other.lat_deg, other.lon_deg).distance_m
