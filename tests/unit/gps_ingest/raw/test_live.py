"""A u-blox receiver behind a TCP port, as gps-ingest reads it from `[[raw]]`."""

import queue
import socketserver
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path

import msgspec
import pytest
import zenoh

from loops import WAIT_S, Run
from wayline.errors import InputError
from wayline.live_sources import LiveRaw
from wayline.messages import GpsRaw
from wayline.satellites.gps_time import week_and_tow_s
from wayline.settings import Settings, load_settings
from wayline_bench.made_up_sky import START_S, epoch, navigation, sky
from wayline_cli.listener import Listener
from wayline_gps_ingest.__main__ import live
from wayline_gps_ingest.raw.live import RawReceiver

PATIENCE_S = 10.0


@contextmanager
def receiver_sending(connections: Sequence[bytes]) -> Iterator[int]:
    """The port of a receiver that sends the first to whoever comes first, then hangs up."""
    left = list(connections)

    class Ubx(socketserver.BaseRequestHandler):
        def handle(self) -> None:
            data = left.pop(0) if left else b""
            for start in range(0, len(data), 100):
                self.request.sendall(data[start : start + 100])

    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Ubx) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server.server_address[1]
        server.shutdown()
        thread.join()


def heard(connections: Sequence[bytes], count: int) -> tuple[list[GpsRaw], RawReceiver]:
    """The first messages of a receiver, and how it does."""
    inputs: queue.SimpleQueue[msgspec.Struct] = queue.SimpleQueue()
    stop, messages = threading.Event(), list[GpsRaw]()
    with receiver_sending(connections) as port:
        receiver = RawReceiver("gps-ingest", LiveRaw(url=f"tcp://127.0.0.1:{port}"))
        reading = threading.Thread(target=receiver.run, args=(inputs.put, stop))
        reading.start()
        while len(messages) < count:
            told = receiver.node.core.handle(inputs.get(timeout=PATIENCE_S), "gps-ingest")
            messages += [message for message in told if isinstance(message, GpsRaw)]
        stop.set()
        reading.join()
    return messages, receiver


def test_measurements_come_with_places_once_the_satellites_were_heard() -> None:
    satellites = sky()
    data = epoch(satellites, START_S) + navigation(satellites) + epoch(satellites, START_S + 1.0)
    messages, receiver = heard([data], 2)
    assert [sum(each.x_m is not None for each in told.satellites) for told in messages] == [
        0,
        len(satellites),
    ]
    assert dict(receiver.faults()) == {}


def test_a_connection_that_breaks_within_a_message_costs_that_one() -> None:
    """What was heard of the satellites stands, and the message after the return is whole."""
    satellites = sky()
    first = (
        navigation(satellites) + epoch(satellites, START_S) + epoch(satellites, START_S + 1)[:90]
    )
    second = epoch(satellites, START_S + 2.0)
    messages, receiver = heard([first, second], 2)
    assert [round((told.t_ns - messages[0].t_ns) * 1e-9) for told in messages] == [0, 2]
    assert all(each.x_m is not None for told in messages for each in told.satellites)
    assert receiver.condition.reconnections >= 1


def test_damaged_messages_are_counted_in_its_condition() -> None:
    satellites = sky()
    damaged = bytearray(epoch(satellites, START_S))
    damaged[40] ^= 0xFF
    _, receiver = heard([bytes(damaged) + epoch(satellites, START_S + 1.0)], 1)
    assert dict(receiver.faults()) == {"checksum": 1}
    assert "1 checksum" in receiver.detail


def test_a_receivers_bytes_come_onto_the_bus(run: Run, session: zenoh.Session) -> None:
    """From its port to the vehicle's key: the time is now, so that nobody refuses it."""
    week, tow_s = week_and_tow_s(time.time_ns())
    tow_s = max(tow_s, 2.0)
    satellites = sky(tow_s, week, toe_s=tow_s // 16 * 16)
    heard_s = [tow_s - 2.0, tow_s - 1.0]
    data = navigation(satellites) + b"".join(epoch(satellites, at, week=week) for at in heard_s)
    with receiver_sending([data]) as port:
        raw = LiveRaw(url=f"tcp://127.0.0.1:{port}")
        settings = Settings(vehicle_id="bus-1", raw=(raw,))
        with closing(Listener(session, "bus-1", ["gps_raw"])) as ear:
            running = run(live(settings), settings)
            ear.await_message("gps_raw", timeout_s=WAIT_S)
            health = running.await_health(
                lambda health: "last fix never" not in (health.detail or "")
            )
            told = ear.heard("gps_raw")
    assert all(each.source == "gps-ingest" for each in told)
    message = told[-1].message
    assert isinstance(message, GpsRaw)
    assert sum(each.x_m is not None for each in message.satellites) == len(satellites) > 3
    assert health.bad_input == 0


def configured(folder: Path, text: str) -> Path:
    path = folder / "wayline.toml"
    path.write_text(f'vehicle_id = "bus-1"\n{text}')
    return path


def test_the_service_has_a_source_for_each_receiver(tmp_path: Path) -> None:
    settings = load_settings(
        configured(
            tmp_path,
            '[[nmea]]\nurl = "tcp://127.0.0.1:1"\n[[raw]]\nurl = "tcp://127.0.0.1:2"\n',
        ),
        {},
    )
    assert [feed.name for feed in live(settings).feeds] == ["gps-ingest", "gps-ingest-2"]


def test_navigation_files_are_beside_the_configuration(tmp_path: Path) -> None:
    text = '[[raw]]\nurl = "udp://:2000"\nformat = "ubx"\nnav = "brdc.nav"\n'
    settings = load_settings(configured(tmp_path, text), {})
    assert settings.raw[0].navs == (str(tmp_path / "brdc.nav"),)
    with pytest.raises(InputError, match=r"brdc\.nav"):
        live(settings)


def test_gpsd_tells_no_raw_measurements(tmp_path: Path) -> None:
    path = configured(tmp_path, '[[raw]]\nurl = "gpsd://localhost"\n')
    with pytest.raises(InputError, match=r"raw\[0\].url"):
        load_settings(path, {})


WITHOUT_EXTRA = """
import sys
sys.modules["pyrtklib5"] = sys.modules["pyubx2"] = None
from pathlib import Path
from wayline.errors import InputError
from wayline.drive_file import load_drive
from wayline_cli.listener import Listener
from wayline_gps_ingest.__main__ import live
from wayline_gps_ingest.recorded import recordings
drive = load_drive(Path(sys.argv[1]))
try:
    list(recordings(drive, "drive.toml")[0].messages)
except InputError as error:
    print(error)
"""


@pytest.mark.parametrize("kind", ["ubx", "csv"])
def test_without_the_extra_tables_are_read_and_the_rest_says_what_is_missing(
    tmp_path: Path, kind: str
) -> None:
    """A vehicle that has no such receiver has nothing of it installed."""
    tables = {
        "ubx": 'path = "raw.ubx"\n',
        "csv": 'path = "raw.csv"\ncolumns = { time = "t", prn = "p", doppler_hz = "d" }\n',
    }
    (tmp_path / "raw.ubx").write_bytes(epoch(sky(), START_S))
    (tmp_path / "raw.csv").write_text("t,p,d\n1767838482,5,100.0\n")
    text = f'[drive]\nvehicle_id = "car"\n[[raw]]\n{tables[kind]}'
    (tmp_path / "drive.toml").write_text(text)
    command = [sys.executable, "-c", WITHOUT_EXTRA, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    if kind == "csv":
        assert done.stdout == ""
    else:
        assert "needs the package" in done.stdout
        assert 'pip install "wayline[raw]"' in done.stdout
