"""Recording and playing on a real bus: what was published comes back under its own keys."""

import queue
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import pytest
import zenoh

from builders import about, at, fix, gyro
from wayline.bus import Publishers, Subscription, open_session
from wayline.codec import decode, encode
from wayline.ending import Ending
from wayline.errors import InputError
from wayline.inbox import Inbox, Sample
from wayline.keys import message_key
from wayline.mcap_log import McapWriter, is_finished, read_messages, read_records
from wayline.messages import TOPICS, Health, Message, Pose
from wayline.router import open_router
from wayline.settings import BusSettings
from wayline_cli.play import Played, play, play_records
from wayline_cli.record import Recorded, record, record_bus

WAIT_S = 10.0


def free_port() -> int:
    """A port that nothing listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port


@pytest.fixture
def bus() -> Iterator[BusSettings]:
    """A router of the test's own."""
    settings = BusSettings(connect=(f"tcp/127.0.0.1:{free_port()}",))
    with open_router(settings):
        yield settings


@pytest.fixture
def session(bus: BusSettings) -> Iterator[zenoh.Session]:
    """A client of it."""
    with open_session(bus) as opened:
        yield opened


class Recording:
    """A recorder in a thread; it has subscribed as soon as something is written."""

    def __init__(self, bus: BusSettings, path: Path) -> None:
        self._bus, self._path = bus, path
        self.heard: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._ending = Ending()
        self._result: queue.SimpleQueue[Recorded] = queue.SimpleQueue()
        threading.Thread(target=self._run).start()

    def _run(self) -> None:
        heard = self.heard

        class Told(McapWriter):
            def write_payload(
                self, key: str, topic: str, payload: bytes, t_ns: int, log_time_ns: int
            ) -> None:
                super().write_payload(key, topic, payload, t_ns, log_time_ns)
                heard.put(key)

        with open_session(self._bus) as session, Told(self._path) as writer:
            result = record_bus(session, writer, self._ending)
        self._result.put(result)

    def await_messages(self, count: int) -> None:
        """Wait until so many more messages are written."""
        for _ in range(count):
            self.heard.get(timeout=WAIT_S)

    def end(self) -> Recorded:
        """Stop it; what came of it, the file closed."""
        self._ending.request()
        return self._result.get(timeout=WAIT_S)


def publish(publishers: Publishers, message: Message, source: str = "test") -> str:
    """Put a message of a vehicle; its key."""
    publishers.put("bus-7", message.topic, source, encode(message))
    return message_key("bus-7", message.topic, source)


DRIVE: tuple[Message, ...] = (
    *(gyro(tenth / 10, tenth) for tenth in range(50)),
    *(fix(second, 55.0, 10.0) for second in range(5)),
    Pose(t_ns=at(5), mode="fused", lat_deg=55.0, lon_deg=10.0),
)
LAST = gyro(6, 0)


def by_key(messages: Iterable[tuple[str, Message]]) -> dict[str, list[Message]]:
    """Messages of each source and topic; only within a key does the bus keep the order."""
    found: dict[str, list[Message]] = {}
    for source, message in messages:
        found.setdefault(message_key("bus-7", message.topic, source), []).append(message)
    return found


def test_everything_published_is_recorded(
    bus: BusSettings, session: zenoh.Session, tmp_path: Path
) -> None:
    path = tmp_path / "a.mcap"
    recording = Recording(bus, path)
    publishers = Publishers(session)
    # a state's newest value reaches late joiners: from then on the recorder hears everything
    publish(publishers, fix(-1, 55.0, 10.0), "first")
    recording.await_messages(1)
    for message in DRIVE:
        publish(publishers, message)
    recording.await_messages(len(DRIVE))
    result = recording.end()
    publishers.close()
    assert result == Recorded({"gps_fix": 6, "gyro": 50, "pose": 1}, 0, 0, 0)
    found = by_key((source, message) for _, source, message in read_messages(path))
    first = ("first", fix(-1, 55.0, 10.0))
    assert found == by_key([first, *(("test", message) for message in DRIVE)])


def recorded_samples(
    session: zenoh.Session, path: Path, samples: Sequence[tuple[str, bytes]], capacity: int = 100
) -> Recorded:
    """What comes of samples that have arrived before the recorder is stopped."""
    inbox, ending = Inbox(capacity), Ending()
    for key, payload in samples:
        inbox.put(Sample(key, payload, at(0)))
    ending.request()
    with McapWriter(path) as writer:
        return record_bus(session, writer, ending, inbox=inbox)


KEY = message_key("bus-7", "gyro", "test")
PLAYER = message_key("bus-7", "health", "play")


def test_what_is_no_message_is_counted_and_not_recorded(
    session: zenoh.Session, tmp_path: Path
) -> None:
    good = encode(gyro(1, 0))
    samples = [
        (KEY, good),
        (KEY, b"{"),
        (message_key("Bus", "gyro", "test"), good),
        (message_key("bus-7", "unheard", "test"), good),
    ]
    result = recorded_samples(session, tmp_path / "a.mcap", samples)
    assert result == Recorded({"gyro": 1}, 0, 0, 3)
    assert [message for _, _, message in read_messages(tmp_path / "a.mcap")] == [gyro(1, 0)]


def test_what_finds_no_room_is_counted(session: zenoh.Session, tmp_path: Path) -> None:
    samples = [(KEY, encode(gyro(second, 0))) for second in range(5)]
    result = recorded_samples(session, tmp_path / "a.mcap", samples, capacity=2)
    assert result == Recorded({"gyro": 2}, 3, 0, 0)


def test_a_recording_ends_after_its_seconds(bus: BusSettings, tmp_path: Path) -> None:
    began_s = time.monotonic()
    record(tmp_path / "a.mcap", bus, seconds=0.3)
    assert 0.3 <= time.monotonic() - began_s < 2.0
    assert is_finished(tmp_path / "a.mcap")


def test_seconds_bound_the_wait_for_a_router_too(tmp_path: Path) -> None:
    """What is there already stays, and so does the place of what is not."""
    nowhere = BusSettings(connect=(f"tcp/127.0.0.1:{free_port()}",))
    began_s = time.monotonic()
    with pytest.raises(InputError, match="no router came within --seconds, nothing was recorded"):
        record(tmp_path / "a.mcap", nowhere, seconds=0.3)
    assert 0.3 <= time.monotonic() - began_s < WAIT_S
    assert not (tmp_path / "a.mcap").exists()


def test_a_recording_is_overwritten_only_by_force(bus: BusSettings, tmp_path: Path) -> None:
    path = recorded_file(tmp_path / "a.mcap")
    before = path.read_bytes()
    with pytest.raises(InputError, match=r"a\.mcap: is there already; .*--force"):
        record(path, bus, seconds=0.1)
    assert path.read_bytes() == before
    record(path, bus, seconds=0.1, force=True)
    assert path.read_bytes() != before


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("nan"), float("inf")])
def test_a_time_that_is_none_is_refused(tmp_path: Path, seconds: float) -> None:
    with pytest.raises(InputError, match="--seconds"):
        record(tmp_path / "a.mcap", BusSettings(), seconds=seconds)


def test_a_folder_that_is_missing_is_said_before_the_router_is_waited_for(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="its folder is missing"):
        record(tmp_path / "none" / "a.mcap", BusSettings())


def test_what_cannot_be_played_is_said_before_the_router_is_waited_for(tmp_path: Path) -> None:
    """Missing, no MCAP, nothing in it."""
    (tmp_path / "text.mcap").write_text("a recording?")
    with McapWriter(tmp_path / "empty.mcap"):
        pass
    said = {"none.mcap": "no such file", "text.mcap": "no MCAP", "empty.mcap": "holds no messages"}
    for name, what in said.items():
        with pytest.raises(InputError, match=what):
            play(tmp_path / name, BusSettings())


def test_a_full_disk_is_named(bus: BusSettings) -> None:
    with pytest.raises(InputError, match=r"/dev/full: cannot be written \(No space"):
        record(Path("/dev/full"), bus, seconds=0.1)


def recorded_file(path: Path) -> Path:
    """A recording of a drive as it was driven, a tenth of a second late."""
    with McapWriter(path) as writer:
        for message in sorted(DRIVE, key=lambda message: message.t_ns):
            writer.write("bus-7", "test", message, message.t_ns + 100_000_000)
        writer.write("bus-7", "last", LAST, LAST.t_ns + 100_000_000)
    return path


def test_playing_restores_keys_payloads_and_order(
    bus: BusSettings, session: zenoh.Session, tmp_path: Path
) -> None:
    path = recorded_file(tmp_path / "a.mcap")
    samples: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
    told: queue.SimpleQueue[bytes] = queue.SimpleQueue()

    def hear(key: str, payload: bytes) -> None:
        if key == PLAYER:
            told.put(payload)
        else:
            samples.put((key, payload))

    subscription = Subscription(session, ["bus-7"], TOPICS, hear)
    played = play(path, bus, speed=20.0)
    expected = [(key, payload) for _, key, payload in read_records(path)]
    found = [samples.get(timeout=WAIT_S) for _ in expected]
    subscription.close()
    assert played == Played(len(expected), about(6.0), complete=True)
    for name in dict(expected):
        assert [x for x in found if x[0] == name] == [x for x in expected if x[0] == name]
    # readers are told that the vehicle's times are a recording's, and when it is over
    healths = [decode("health", told.get(timeout=WAIT_S)) for _ in range(told.qsize())]
    recorded = [health.recorded for health in healths if isinstance(health, Health)]
    assert recorded == [True] * (len(recorded) - 1) + [False]
    assert len(recorded) > 1


def test_a_recording_from_before_the_bus_moved_is_played_under_the_keys_of_today(
    tmp_path: Path,
) -> None:
    path, payload = tmp_path / "a.mcap", encode(gyro(1, 0))
    with McapWriter(path) as writer:
        writer.write_payload("wayline/@v1/bus-7/gyro/test", "gyro", payload, at(1), at(1))
    put: list[tuple[str, str, str, bytes]] = []
    play_records(read_records(path), lambda *each: put.append(each), Ending(), speed=1.0)
    assert put == [("bus-7", "gyro", "test", payload)]
    assert [message for _, _, message in read_messages(path)] == [gyro(1, 0)]


def test_a_late_joiner_gets_the_last_played_pose(
    bus: BusSettings, session: zenoh.Session, tmp_path: Path
) -> None:
    records = read_records(recorded_file(tmp_path / "a.mcap"))
    samples: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    with open_session(bus) as player:
        publishers = Publishers(player)
        play_records(records, publishers.put, Ending(), speed=100.0)
        late = Subscription(session, ["bus-7"], ["pose"], lambda _, payload: samples.put(payload))
        assert decode("pose", samples.get(timeout=WAIT_S)) == DRIVE[-1]
        late.close()
        publishers.close()


def paced(log_times_s: list[float], speed: float) -> list[float]:
    """When records with these arrival times are put, in seconds after the start."""
    put_s: list[float] = []
    records = [(at(each), KEY, b"{}") for each in log_times_s]
    began_s = time.monotonic()
    play_records(
        records, lambda *_: put_s.append(time.monotonic() - began_s), Ending(), speed=speed
    )
    return put_s


def test_playing_keeps_the_pace_at_its_speed() -> None:
    # the recorder's clock steps back once
    assert paced([0.0, 1.0, 0.5, 2.0], 5.0) == pytest.approx([0.0, 0.2, 0.2, 0.4], abs=0.1)


@pytest.mark.parametrize("next_s", [0, 1000])
def test_playing_stops_when_asked(next_s: float) -> None:
    ending = Ending()
    records = [(at(each), KEY, b"{}") for each in (0, next_s)]
    began_s = time.monotonic()
    result = play_records(records, lambda *_: ending.request(), ending, speed=1.0)
    assert result == (1, 0.0)
    assert time.monotonic() - began_s < WAIT_S


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan"), float("inf")])
def test_a_speed_that_is_none_is_refused(tmp_path: Path, speed: float) -> None:
    with pytest.raises(InputError, match="--speed"):
        play(recorded_file(tmp_path / "a.mcap"), BusSettings(), speed=speed)


def test_a_cut_recording_plays_and_says_so(bus: BusSettings, tmp_path: Path) -> None:
    path = recorded_file(tmp_path / "a.mcap")
    path.write_bytes(path.read_bytes()[:-100])
    played = play(path, bus, speed=1000.0)
    assert played == Played(len(DRIVE) + 1, about(6.0), complete=False)


WAITING = """
import sys
from pathlib import Path
from wayline.settings import BusSettings
from wayline_cli.record import record
settings = BusSettings(connect=(sys.argv[1],))
print(record(Path(sys.argv[2]), settings, say=lambda line: print(line, flush=True)))
"""


def recorder(endpoint: str, path: Path) -> subprocess.Popen[str]:
    """A recorder in a process of its own."""
    command = [sys.executable, "-c", WAITING, endpoint, str(path)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def ended(process: subprocess.Popen[str]) -> tuple[str, int]:
    """What else it says after SIGTERM, and its status."""
    process.send_signal(signal.SIGTERM)
    said, _ = process.communicate(timeout=WAIT_S)
    return said, process.returncode


def test_a_recorder_ends_on_sigterm_with_its_file_closed(bus: BusSettings, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    process = recorder(bus.connect[0], path)
    assert process.stdout is not None
    assert process.stdout.readline() == f"recording to {path}\n"
    assert ended(process) == (f"{Recorded({}, 0, 0, 0)}\n", 0)
    assert is_finished(path)


def test_a_recorder_without_a_router_says_so_and_ends_on_sigterm(tmp_path: Path) -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    process = recorder(endpoint, tmp_path / "a.mcap")
    assert process.stdout is not None
    assert process.stdout.readline() == f"waiting for a router at {endpoint}\n"
    assert ended(process) == (f"{Recorded({}, 0, 0, 0)}\n", 0)


def test_the_router_process_routes_until_sigterm(tmp_path: Path) -> None:
    settings = BusSettings(connect=(f"tcp/127.0.0.1:{free_port()}",))
    config = tmp_path / "wayline.toml"
    config.write_text(f'[bus]\nconnect = ["{settings.connect[0]}"]\n')
    command = [sys.executable, "-m", "wayline.router", "--config", str(config)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == f"routing at {settings.connect[0]}\n"
        samples: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        with open_session(settings) as here, open_session(settings) as there:
            heard = Subscription(here, ["bus-7"], ["pose"], lambda _, payload: samples.put(payload))
            publishers = Publishers(there)
            publish(publishers, DRIVE[-1])
            assert decode("pose", samples.get(timeout=WAIT_S)) == DRIVE[-1]
            publishers.close()
            heard.close()
        assert ended(process) == ("", 0)


def test_a_second_router_at_the_same_place_is_named(bus: BusSettings) -> None:
    with pytest.raises(InputError, match=r"cannot listen .* stop what listens there already"):
        open_router(bus)
