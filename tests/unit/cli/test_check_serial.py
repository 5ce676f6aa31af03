"""What the doctor hears on serial lines; a pseudo-terminal stands in for a receiver."""

import os
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
import serial

from outlets import Plug, Talker
from wayline.live_sources import LiveNmea, LiveRaw
from wayline_bench.made_up_ubx import Signal, rawx, ubx
from wayline_cli.check import Check, Mark
from wayline_cli.check_serial import check_receivers
from wayline_cli.listen_serial import Hearing, listen

CONFIGURED = LiveNmea(url="serial:///dev/ttyUSB0?baud=9600")
MON_VER_POLL = bytes.fromhex("b56201020000030a")


@pytest.fixture
def plug(tmp_path: Path) -> Iterator[Plug]:
    plugged = Plug(tmp_path / "receiver")
    yield plugged
    plugged.unplug()


def listen_to(plug: Plug) -> Hearing:
    return listen(LiveNmea(url=f"serial://{plug.device}"))


def check(heard: Hearing, devices: tuple[str, ...] = ()) -> list[Check]:
    return check_receivers([CONFIGURED], lambda _: heard, lambda: list(devices))


def test_a_receiver_is_heard_with_its_rate_its_sentences_and_its_fix(plug: Plug) -> None:
    """Within seconds, by the code that the service itself reads it with."""
    # the test's own end of the line would look like another program
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("wayline_cli.listen_serial.holder_of", lambda _: None)
        talker = Talker(plug.write)
        try:
            heard = listen_to(plug)
        finally:
            talker.close()
    assert heard == Hearing(None, "9600 baud", ("GPGGA", "GPRMC"), has_fix=True)


def test_u_blox_binary_is_told_from_silence(plug: Plug) -> None:
    """A receiver whose NMEA output is off is there; a line on which nothing comes is silent."""
    stop = threading.Event()

    def speak() -> None:
        while not stop.wait(0.2):
            plug.write(MON_VER_POLL)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("wayline_cli.listen_serial.holder_of", lambda _: None)
        patch.setattr("wayline_cli.listen_serial.SILENT_S", 1.0)
        assert listen_to(plug).problem == "silent"
        speaker = threading.Thread(target=speak)
        speaker.start()
        try:
            heard = listen_to(plug)
        finally:
            stop.set()
            speaker.join()
    assert heard == Hearing("sends nothing readable", "9600 baud, u-blox binary only")


def test_a_line_that_another_program_has_open_is_left_alone(plug: Plug) -> None:
    """By its lock, and by who holds it, which also finds programs that do not lock."""
    assert f"(process {os.getpid()})" in (listen_to(plug).problem or "")
    with (
        pytest.MonkeyPatch.context() as patch,
        serial.Serial(str(plug.device), exclusive=True),
    ):
        patch.setattr("wayline_cli.listen_serial.holder_of", lambda _: None)
        assert listen_to(plug) == Hearing("in use by another program")


def test_a_line_that_is_not_there_is_said_with_those_that_are(tmp_path: Path) -> None:
    """The mend is to plug it in or to name another."""
    missing = LiveNmea(url=f"serial://{tmp_path}/ttyUSB9")
    (found,) = check_receivers([missing], listen, list)
    assert (found.mark, found.finding) == (Mark.WRONG, "is not there")
    (first, _) = check(Hearing("is not there"), ("/dev/ttyS0",))
    assert "present: /dev/ttyS0" in first.mend


@pytest.mark.parametrize(
    ("heard", "mark", "words"),
    [
        (Hearing(None, "9600 baud", ("GPRMC",), has_fix=True), Mark.FINE, ""),
        (Hearing(None, "9600 baud", ("GPRMC",)), Mark.NOTE, "antenna"),
        (Hearing("in use by gpsd (process 7)"), Mark.FINE, ""),
        (Hearing("may not be read, its group (dialout) is needed"), Mark.WRONG, "dialout"),
        (Hearing("silent", "9600 baud being tried"), Mark.WRONG, "wiring"),
        (Hearing("sends nothing readable", "9600 baud, u-blox binary only"), Mark.WRONG, "gpsd"),
    ],
)
def test_each_finding_has_its_verdict_and_mend(heard: Hearing, mark: Mark, words: str) -> None:
    """What a technician is to do next."""
    (found,) = check(heard)
    assert (found.subject, found.mark) == ("receiver /dev/ttyUSB0", mark)
    assert words in found.mend


def test_a_receiver_that_no_table_names_is_shown_with_the_url_to_give(tmp_path: Path) -> None:
    """Other devices are only mentioned: a silent modem is not wrong."""
    speaks = Hearing(None, "4800 baud", ("GPRMC",), has_fix=True)
    _, other = check(speaks, ("/dev/ttyUSB0", "/dev/ttyACM1"))
    assert (other.subject, other.mark) == ("serial line /dev/ttyACM1", Mark.NOTE)
    assert 'url = "serial:///dev/ttyACM1"' in other.mend
    _, silent = check(Hearing("silent"), ("/dev/ttyUSB0", "/dev/ttyACM1"))
    assert silent.mark is Mark.FINE


@pytest.mark.parametrize(("state", "mark"), [(True, Mark.FINE), (False, Mark.WRONG)])
def test_a_raw_source_is_heard_by_its_messages(
    plug: Plug, monkeypatch: pytest.MonkeyPatch, state: bool, mark: Mark
) -> None:
    """Its rate is found as a receiver's of sentences; what it lacks is named."""
    monkeypatch.setattr("wayline_cli.listen_serial.holder_of", lambda _: None)
    message = rawx(2400, 1.0, [Signal(3, 2.2e7)]) if state else ubx(0x01, 0x07, bytes(92))
    raw = LiveRaw(url=f"serial://{plug.device}")
    stop = threading.Event()

    def speak() -> None:
        while not stop.wait(0.2):
            plug.write(message)

    speaking = threading.Thread(target=speak)
    speaking.start()
    (found,) = check_receivers([raw], listen, list)
    stop.set()
    speaking.join()
    kinds = "RXM-RAWX" if state else "other UBX, no RXM-RAWX"
    assert (found.mark, found.finding) == (mark, f"9600 baud: {kinds}")
    assert state or "RXM-SFRBX" in found.mend
