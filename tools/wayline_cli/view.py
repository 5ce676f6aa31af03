"""Makes a Rerun recording of a drive, of a replay's output or of an MCAP file, and opens it."""

import heapq
import os
import signal
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import msgspec

from wayline.codec import decode
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.messages import TOPICS, Message
from wayline.route import Route
from wayline.route_file import load_route
from wayline_replay.replay import replay

if TYPE_CHECKING:
    from wayline.rerun_view import RerunRecording

FILE_BATCH_S = 60.0
"""Rows sent together to a file: nobody waits for them."""

Logged = tuple[str, str, Message]
"""Vehicle, source and message."""
Progressed = Callable[[float], None]


class Viewed(NamedTuple):
    """What `view` made of its source."""

    path: Path
    """The recording; gone after the viewer closed unless it was to be saved."""
    rows: int
    elapsed_s: float
    """For reading and writing, the viewer's time not counted."""


def view(
    source: Path,
    save: Path | None = None,
    *,
    route_path: Path | None = None,
    progressed: Progressed = lambda _: None,
) -> Viewed:
    """Record a drive's folder, a replay's output folder or an MCAP file for Rerun.

    Without `save` the viewer is opened on it and waited for. The route drawn is `route_path`'s,
    else the drive's own where it has some. `progressed` gets the seconds replayed, of a drive.
    Raises InputError.
    """
    if save is None:
        _check_display()
    with tempfile.TemporaryDirectory(prefix="wayline-view-") as scratch:
        path = save or Path(scratch) / f"{source.stem}.rrd"
        viewed = _record(source, path, route_path, Path(scratch), progressed)
        if save is None:
            open_viewer(path)
    return viewed


def _record(
    source: Path, path: Path, route_path: Path | None, scratch: Path, progressed: Progressed
) -> Viewed:
    route_paths = [route_path] if route_path else []
    if is_drive(source):
        drive = load_drive(source)
        if not route_paths and drive.route:
            route_paths = [Path(each) for each in drive.route.paths]
        out = scratch / "replay"
        replay(source, out, route_paths=route_paths, progressed=progressed)
        source = out
    started = time.perf_counter()
    messages = read_logged(source)
    rows = write_recording(messages, path, [load_route(each) for each in route_paths])
    return Viewed(path, rows, time.perf_counter() - started)


def write_recording(messages: Iterator[Logged], path: Path, routes: Sequence[Route] = ()) -> int:
    """Write messages to a Rerun recording; the number of its rows. Raises InputError."""
    first = next(messages, None)
    if first is None:
        raise InputError(str(path), "nothing to show", "give a source that holds messages")
    with _open_recording(path, {first[0]: routes}) as recording:
        recording.log(first[0], first[2], first[1])
        for vehicle_id, source, message in messages:
            recording.log(vehicle_id, message, source)
        recording.flush()
        return recording.rows_sent


def _open_recording(path: Path, routes: Mapping[str, Sequence[Route]]) -> "RerunRecording":
    try:
        from wayline.rerun_view import RerunRecording  # noqa: PLC0415 - an extra
    except ImportError as error:
        mend = 'install it with: pip install "wayline[rerun]"'
        raise InputError("wayline view", f"{error.name} is not installed", mend) from None
    return RerunRecording(save=path, routes=routes, batch_s=FILE_BATCH_S)


def is_drive(source: Path) -> bool:
    """Whether a source is a drive's folder or its `drive.toml`."""
    return source.suffix == ".toml" or (source / "drive.toml").exists()


def read_logged(source: Path) -> Iterator[Logged]:
    """Messages of a replay's output folder or of an MCAP file, in order of time.

    Raises InputError, for a line that is no message while iterating.
    """
    if source.suffix == ".mcap":
        if not source.is_file():
            raise InputError(str(source), "no such file", "record one with wayline record")
        from wayline.mcap_log import read_messages  # noqa: PLC0415 - needs the library mcap

        return iter(read_messages(source))
    files = [path for topic in TOPICS if (path := source / f"{topic}.jsonl").exists()]
    if not files:
        mend = "give a drive's folder, a replay's output folder or a .mcap file"
        raise InputError(str(source), "neither a drive nor a recording", mend)
    shown = [path for path in files if path.stem in _shown_topics()]
    # a topic's messages are nearly in order (late fixes are not), which is enough for a viewer
    return heapq.merge(*map(_read_lines, shown), key=lambda logged: logged[2].t_ns)


def _shown_topics() -> frozenset[str]:
    try:
        from wayline.rerun_view import READS  # noqa: PLC0415 - an extra
    except ImportError:
        return frozenset(TOPICS)
    return frozenset(message.topic for message in READS)


class _Head(msgspec.Struct):
    vehicle_id: str
    source: str


def _read_lines(path: Path) -> Iterator[Logged]:
    heads = msgspec.json.Decoder(_Head)
    with path.open("rb") as lines:
        for number, line in enumerate(lines, start=1):
            try:
                head, message = heads.decode(line), decode(path.stem, line)
            except msgspec.DecodeError as error:
                mend = "replay the drive again"
                raise InputError(f"{path}:{number}", str(error), mend) from None
            yield head.vehicle_id, head.source, message


def _check_display() -> None:
    needs_display = sys.platform.startswith("linux")
    if needs_display and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        mend = "add --save FILE.rrd and open the file where there is one with: rerun FILE.rrd"
        raise InputError("wayline view", "there is no display to open the viewer on", mend)


def viewer_program() -> Path:
    """The viewer that comes with Rerun's SDK."""
    return Path(sysconfig.get_path("scripts")) / "rerun"


def open_viewer(path: Path) -> None:
    """Open a recording in Rerun's viewer and wait until it is closed. Raises InputError."""
    program = viewer_program()
    # the viewer listens for recorders too: unless told, on every interface
    command = [str(program), "--bind", "127.0.0.1", "--port", "auto", str(path)]
    try:
        viewer = subprocess.Popen(command, start_new_session=True)  # noqa: S603 - our own program
    except OSError as error:
        mend = 'install it with: pip install "wayline[rerun]"'
        raise InputError(str(program), error.strerror or str(error), mend) from None
    try:
        status = viewer.wait()
    except KeyboardInterrupt:
        # the program is a small script around the viewer: both must end
        os.killpg(viewer.pid, signal.SIGTERM)
        raise
    if status != 0:
        mend = "add --save FILE.rrd and open the file elsewhere"
        raise InputError("the Rerun viewer", f"it ended with status {status}", mend)
