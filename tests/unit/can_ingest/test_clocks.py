"""A bus's times, by its logger and by its clock signal, when they are nonsense for a while."""

from pathlib import Path

import cantools
import pytest
from cantools.database.can import Database

from builders import at, frame
from wayline.drive import CanSource, Clock, Drive, DriveInfo, SignalMapping, Vehicle
from wayline.inputs import Flush
from wayline.messages import Message
from wayline.received import Recording
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.mapping import compile_mapping
from wayline_can_ingest.recorded import recordings
from wayline_can_ingest.utc import DriveClock

DBC = """VERSION ""
BU_: ECU
BO_ 257 Imu: 2 ECU
 SG_ Rate : 0|16@1- (0.01,0) [-300|300] "deg/s" ECU
BO_ 263 Clock: 8 ECU
 SG_ Utc : 0|64@1+ (0.001,0) [0|1e12] "s" ECU
"""
RATE = {"gyro.yaw_rate_degps": SignalMapping(message="Imu", signal="Rate")}
CLOCK = Clock(message="Clock", signal="Utc")
START_S = 1_587_045_541.0
HOUR_S, ERA_S, YEARS_S = 3_600.0, 1_024 * 604_800.0, 20 * 365 * 86_400.0
Row = tuple[float, str]


def told(utc_s: float) -> str:
    """A frame of the clock signal."""
    return f"107#{round(utc_s * 1000).to_bytes(8, 'little').hex().upper()}"


def recording(folder: Path, rows: list[Row], *, clock: Clock | None = None) -> Recording:
    """A candump log as the drive's only bus."""
    (folder / "a.dbc").write_text(DBC, encoding="ascii")
    text = "".join(f"({seconds:.6f}) can0 {data}\n" for seconds, data in rows)
    (folder / "a.log").write_text(text, encoding="ascii")
    source = CanSource(
        path=str(folder / "a.log"), dbc=(str(folder / "a.dbc"),), signals=RATE, clock=clock
    )
    (only,) = recordings(Drive(drive=DriveInfo(vehicle_id="car"), can=(source,)), "drive.toml")
    return only


def seconds_of(recording: Recording) -> list[float]:
    """Of each message, which must have been received as it was measured."""
    heard = list(recording.messages)
    assert all(received_ns == message.t_ns for received_ns, message in heard)
    return [message.t_ns / 1e9 - START_S for _, message in heard]


@pytest.mark.parametrize("leap_s", [HOUR_S, ERA_S, YEARS_S])
@pytest.mark.parametrize(("first", "last"), [(0, 30), (100, 190), (250, 300)])
def test_frames_of_a_time_ahead_are_lost_and_no_others(
    tmp_path: Path, first: int, last: int, leap_s: float
) -> None:
    """A logger whose clock was not set for some seconds, at 10 frames a second."""
    rows = [
        (START_S + number / 10 + (leap_s if first <= number < last else 0.0), "101#6400")
        for number in range(300)
    ]
    bus = recording(tmp_path, rows)
    right = [number / 10 for number in range(300) if not first <= number < last]
    assert seconds_of(bus) == pytest.approx(right, abs=1e-5)
    assert bus.bad_input() == last - first


def test_a_log_that_pauses_for_hours_goes_on(tmp_path: Path) -> None:
    times_s = [number / 10 + (5 * HOUR_S if number >= 100 else 0.0) for number in range(300)]
    bus = recording(tmp_path, [(START_S + seconds, "101#6400") for seconds in times_s])
    assert seconds_of(bus) == pytest.approx(times_s, abs=1e-5)
    assert bus.bad_input() == 0


@pytest.mark.parametrize("from_s", [0.0, START_S - 86_400.0, START_S])
@pytest.mark.parametrize("leap_s", [-ERA_S / 2, HOUR_S, ERA_S, YEARS_S])
def test_a_clock_signal_that_tells_nonsense_first_is_not_believed(
    tmp_path: Path, leap_s: float, from_s: float
) -> None:
    """Five seconds of it, whether the logger's own clock counts from 0, is off or right."""
    rows = []
    for second in range(40):
        leap = leap_s if second < 5 else 0.0
        rows += [
            (from_s + second, "101#6400"),
            (from_s + second, told(START_S + second + leap)),
        ]
    bus = recording(tmp_path, rows, clock=CLOCK)
    assert seconds_of(bus) == pytest.approx(list(range(40)), abs=1e-5)
    assert bus.bad_input() == 0


def test_a_clock_signal_told_once_is_taken_at_its_word(tmp_path: Path) -> None:
    rows = [(2.0, "101#6400"), (3.0, told(START_S)), (4.0, "101#6400")]
    assert seconds_of(recording(tmp_path, rows, clock=CLOCK)) == pytest.approx([-1.0, 1.0])


def live_core() -> CanIngestCore:
    """As the service makes it, on a machine whose clock is right."""
    database = cantools.database.load_string(DBC, strict=False)
    assert isinstance(database, Database)
    source = CanSource(path="-", signals=RATE, clock=CLOCK)
    mapping = compile_mapping(source, [database], Vehicle(), "configuration")
    clock = DriveClock.of(source, doubts_start=True, clock_from_ns=at(0.0))
    return CanIngestCore(source, mapping, Vehicle(), clock=clock)


def test_a_live_clock_signal_that_the_host_bears_out_counts_at_once() -> None:
    core = live_core()
    core.handle(frame(1.0, 263, told(at(1.2) / 1e9)[4:]), "can-ingest")
    (message,) = core.handle(frame(2.0, 257, "6400"), "can-ingest")
    assert message.t_ns == pytest.approx(at(2.2), abs=10**6)


def test_a_live_clock_signal_against_the_host_counts_once_ten_agree() -> None:
    core = live_core()
    messages: list[Message] = []
    for second in range(12):
        messages += core.handle(frame(second, 257, "6400"), "can-ingest")
        messages += core.handle(frame(second, 263, told(at(second) / 1e9 + HOUR_S)[4:]), "")
    messages += core.handle(Flush(0), "can-ingest")
    assert [(message.t_ns - at(HOUR_S)) / 1e9 for message in messages] == pytest.approx(
        list(range(12)), abs=1e-2
    )


def test_a_time_that_no_message_may_carry_is_counted_and_dropped(tmp_path: Path) -> None:
    rows = [(START_S, "101#6400"), (42.8, "101#6400"), (43.8, "101#6400")]
    bus = recording(tmp_path, rows)
    assert seconds_of(bus) == []
    assert bus.bad_input() == 3


@pytest.mark.parametrize("at", [1, 5, 20])
def test_a_single_time_of_1970_costs_itself(tmp_path: Path, at: int) -> None:
    """Digits lost on the way, while the log's beginning is still in doubt."""
    rows = [(START_S + number / 10, "101#6400") for number in range(20)]
    bus = recording(tmp_path, [*rows[:at], (42.8, "101#6400"), *rows[at:]])
    assert seconds_of(bus) == pytest.approx([number / 10 for number in range(20)], abs=1e-5)
    assert bus.bad_input() == 1
