"""`wayline view` on real recordings, and the live recording as another program gets it."""

import os
import shutil
import signal
import socket
import subprocess
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from rerun.chunk import RrdReader

from builders import START_NS, at, odometer
from wayline.errors import InputError
from wayline.mcap_log import McapWriter
from wayline.messages import GpsFix, Pose
from wayline.rerun_view import LOOPBACK, RerunRecording
from wayline_cli.view import Viewed, read_logged, view, viewer_program
from wayline_replay.replay import replay

DEADLINE_S = 30.0


def rows_by_entity(path: Path) -> Counter[str]:
    """Rows of a recording, what is static left out."""
    rows: Counter[str] = Counter()
    with warnings.catch_warnings():
        # a file that is still being written has no index yet
        warnings.filterwarnings("ignore", message="RRD file has no footer")
        for chunk in RrdReader(path).stream().to_chunks():
            if chunk.timeline_names:
                rows[chunk.entity_path] += chunk.num_rows
    return rows


@pytest.fixture
def free_port() -> int:
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def short_drive(recorded: Callable[[str], Path]) -> Path:
    """Once round a block in 137 s, with GPS, wheel speed, gyro and barometer."""
    return recorded("ikhyd-trip2")


def test_a_drive_and_its_replay_give_the_same_recording(short_drive: Path, tmp_path: Path) -> None:
    summary = replay(short_drive, tmp_path / "out")
    of_drive = view(short_drive, tmp_path / "drive.rrd")
    of_replay = view(tmp_path / "out", tmp_path / "replay.rrd")
    rows = rows_by_entity(tmp_path / "drive.rrd")
    assert rows == rows_by_entity(tmp_path / "replay.rrd")
    assert of_drive.rows == of_replay.rows == sum(rows.values())

    root = f"/{summary.vehicle_id}"
    fixes = [m for _, _, m in read_logged(tmp_path / "out") if isinstance(m, GpsFix)]
    assert rows[f"{root}/map/fixes"] == sum(fix.valid for fix in fixes) > 100
    assert rows[f"{root}/map/path"] > 100
    assert rows[f"{root}/map/ellipse_95"] > 200
    assert rows[f"{root}/calibration/gyro_bias_degps"] == summary.counts["fusion_status"]
    assert {entity.split("/")[2] for entity in rows} >= {
        "map", "speed", "altitude", "grade", "innovations", "calibration", "states",
    }  # fmt: skip


def test_rows_lie_on_measurement_time(short_drive: Path, tmp_path: Path) -> None:
    """So that a viewer's cursor says when it was, not when it was recorded."""
    replay(short_drive, tmp_path / "out")
    view(tmp_path / "out", tmp_path / "a.rrd")
    messages = [message for _, _, message in read_logged(tmp_path / "out")]
    poses = [m for m in messages if isinstance(m, Pose) and m.speed_mps is not None]
    times_ns: list[int] = []
    for chunk in RrdReader(tmp_path / "a.rrd").stream().to_chunks():
        if chunk.entity_path.endswith("/speed/fused") and chunk.timeline_names:
            column = chunk.to_record_batch().column("measurement_time")
            times_ns += column.cast("int64").to_pylist()
    assert sorted(times_ns) == [pose.t_ns for pose in poses]
    assert len(poses) > 1300


def test_an_mcap_file_gives_a_recording(tmp_path: Path) -> None:
    writer = McapWriter(tmp_path / "a.mcap")
    for number in range(20):
        message = odometer(number * 0.1, 5.0)
        writer.write("bus-7", "can-ingest", message, message.t_ns)
    writer.close()
    viewed = view(tmp_path / "a.mcap", tmp_path / "a.rrd")
    assert viewed == Viewed(tmp_path / "a.rrd", 20, viewed.elapsed_s)
    assert rows_by_entity(viewed.path) == {"/bus-7/speed/odometer/can-ingest": 20}


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("empty", None, "neither a drive nor a recording; give a drive's folder"),
        ("none.mcap", None, "no such file; record one"),
        ("cut", '{"vehicle_id":"a","source":"b","t_ns', r"odometer\.jsonl:1: .*; replay the drive"),
        ("blank", "", "nothing to show; give a source that holds messages"),
    ],
)
def test_what_is_no_recording_is_refused(
    tmp_path: Path, name: str, text: str | None, message: str
) -> None:
    source = tmp_path / name
    if text is not None:
        source.mkdir()
        (source / "odometer.jsonl").write_text(text)
    with pytest.raises(InputError, match=message):
        view(source, tmp_path / "a.rrd")


def test_without_a_display_it_says_how_to_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(InputError, match=r"no display .*; add --save FILE\.rrd"):
        view(tmp_path)


@pytest.fixture
def subscriber(free_port: int, tmp_path: Path) -> Iterator[Callable[[], Path]]:
    """Starts Rerun's own program, which writes what it gets from the live recording to a file."""
    processes: list[subprocess.Popen[bytes]] = []

    def start() -> Path:
        path = tmp_path / "received.rrd"
        address = f"rerun+http://{LOOPBACK}:{free_port}/proxy"
        command = [str(viewer_program()), address, "--save", str(path)]
        home = {"HOME": str(tmp_path), "PATH": os.environ["PATH"]}
        log = (tmp_path / "rerun.log").open("wb")
        with log:
            process = subprocess.Popen(
                command, env=home, stdout=log, stderr=log, start_new_session=True
            )
        processes.append(process)
        return path

    assert shutil.which(viewer_program())
    yield start
    for process in processes:
        os.killpg(process.pid, signal.SIGTERM)
        process.wait()


def received(path: Path) -> int:
    if not path.exists():
        return 0
    try:
        return sum(rows_by_entity(path).values())
    except (ValueError, RuntimeError):  # the program is in the middle of writing it
        return 0


def test_a_late_viewer_gets_what_was_before_and_what_comes(
    free_port: int, subscriber: Callable[[], Path], tmp_path: Path
) -> None:
    with RerunRecording(port=free_port, save=tmp_path / "sent.rrd") as recording:
        assert recording.address == f"rerun+http://127.0.0.1:{free_port}/proxy"
        for number in range(20):
            recording.log("bus-7", odometer(number * 0.1, 5.0), "s")
        recording.flush()
        path = subscriber()
        end = time.monotonic() + DEADLINE_S
        seconds = 2.0
        while received(path) < 40 and time.monotonic() < end:
            recording.log("bus-7", odometer(seconds, 5.0), "s")
            recording.flush()
            seconds += 0.1
            time.sleep(0.05)
        assert received(path) >= 40
    sent = rows_by_entity(tmp_path / "sent.rrd")
    assert sent["/bus-7/speed/odometer/s"] == recording.rows_sent == round(seconds / 0.1)


def test_a_live_recording_is_reached_on_loopback_only(free_port: int) -> None:
    """A server bound to every address would answer at 127.0.0.2 too."""
    with RerunRecording(port=free_port) as recording:
        recording.log("bus-7", odometer(0.0, 5.0), "s")
        socket.create_connection((LOOPBACK, free_port), timeout=5.0).close()
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.2", free_port), timeout=5.0)


def test_a_port_that_is_taken_is_refused(free_port: int) -> None:
    with socket.socket() as other:
        other.bind((LOOPBACK, free_port))
        other.listen()
        with pytest.raises(InputError, match=f"port {free_port}: .*in use; close the viewer"):
            RerunRecording(port=free_port)


def test_messages_of_all_topics_come_in_order_of_time(tmp_path: Path) -> None:
    for topic, times_s in (("odometer", (0.0, 2.0)), ("pose", (1.0, 3.0))):
        lines = [
            f'{{"vehicle_id":"a","source":"{topic}","t_ns":{at(t)},"mode":"gps"}}\n'
            for t in times_s
        ]
        (tmp_path / f"{topic}.jsonl").write_text("".join(lines))
    logged = [(source, message.t_ns - START_NS) for _, source, message in read_logged(tmp_path)]
    seconds = [(source, t_ns / 1e9) for source, t_ns in logged]
    assert seconds == [("odometer", 0.0), ("pose", 1.0), ("odometer", 2.0), ("pose", 3.0)]
