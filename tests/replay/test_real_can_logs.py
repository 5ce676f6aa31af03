"""CAN logs as people have them through `wayline replay`: read, or refused with the reason."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from typer.testing import CliRunner

from can_files import START_S, drive_of, recording
from wayline.errors import InputError
from wayline_cli.__main__ import app

CASES = Path(__file__).parents[1] / "cases"
COMMAND = Path(sys.executable).with_name("wayline")
RMC = "$GPRMC,1359{:02}.00,A,48{:02}.00000,N,01131.00000,E,27.0,0.0,160420,,,A\n"
NMEA_SOURCE = '[[nmea]]\npath = "g.nmea"\n'


class Ended(NamedTuple):
    """How a command ended, and what a replay wrote."""

    status: int
    out: str
    error: str
    folder: Path

    def topic(self, name: str) -> list[dict[str, Any]]:
        """The messages of one topic."""
        with (self.folder / f"{name}.jsonl").open("rb") as file:
            return [json.loads(line) for line in file]

    @property
    def said(self) -> str:
        """The one line of a refusal."""
        assert self.status == 2, self
        assert self.error.count("\n") == 1, self.error
        assert "Traceback" not in self.error
        return self.error


def replayed(drive: Path, folder: Path, *options: str) -> Ended:
    """`wayline replay` of a drive, within this process."""
    return invoked(folder, "replay", str(drive), "--out", str(folder / "out"), *options)


def invoked(folder: Path, *arguments: str) -> Ended:
    """A `wayline` command within this process."""
    result = CliRunner().invoke(app, arguments, env={"COLUMNS": "120"})
    if isinstance(result.exception, InputError):
        return Ended(2, result.output, f"wayline: {result.exception}\n", folder / "out")
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return Ended(result.exit_code, result.stdout, result.stderr, folder / "out")


def ended(folder: Path, *arguments: str) -> Ended:
    """A `wayline` command as a process, on a machine of another time zone."""
    done = subprocess.run(
        [COMMAND, *arguments],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "TZ": "America/New_York", "COLUMNS": "120"},
    )
    return Ended(done.returncode, done.stdout, done.stderr, folder / "out")


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """A place for a copy of a case, which a test may change."""
    return tmp_path / "case"


def copied(case: Path, name: str, old: str = "", new: str = "") -> Path:
    """A case with one thing of its drive file changed."""
    shutil.copytree(CASES / name, case)
    text = (case / "drive.toml").read_text(encoding="utf-8")
    assert old in text
    (case / "drive.toml").write_text(text.replace(old, new, 1), encoding="utf-8")
    return case


def test_the_date_of_an_asc_header_is_used_beside_a_receiver(tmp_path: Path) -> None:
    """As UTC, whatever this machine's time zone."""
    arguments = ("replay", str(CASES / "asc-header-date"), "--out", str(tmp_path / "out"))
    run = ended(tmp_path, *arguments)
    times_s = [row["t_ns"] * 1e-9 for row in run.topic("odometer")]
    assert len(times_s) == 100
    assert times_s[0] == pytest.approx(START_S, abs=1e-6)
    assert "fused" in {row["mode"] for row in run.topic("pose")}
    assert min(row["t_ns"] for row in run.topic("pose")) * 1e-9 > START_S - 1.0


def test_a_header_date_by_the_clock_on_the_wall_has_a_timezone(case: Path, tmp_path: Path) -> None:
    """13:59:01 in Berlin is 11:59:01 UTC in April."""
    drive = copied(case, "asc-header-date", "dbc =", 'timezone = "Europe/Berlin"\ndbc =')
    run = replayed(drive, tmp_path)
    assert run.topic("odometer")[0]["t_ns"] * 1e-9 == pytest.approx(START_S - 7200.0, abs=1e-6)


def test_relative_times_of_an_asc_are_summed(tmp_path: Path) -> None:
    """20 frames 0.1 s apart."""
    run = replayed(CASES / "asc-relative", tmp_path)
    times_s = [row["t_ns"] * 1e-9 - START_S for row in run.topic("odometer")]
    assert times_s == pytest.approx([0.1 * number for number in range(1, 21)], abs=1e-6)


@pytest.mark.parametrize(
    ("name", "seconds", "last"),
    [
        ("gvret.csv", 1.9, 946_684_800 + 166.064),
        ("busmaster.log", 19.0, 1_603_459_980.8331),
        ("stdout.log", 19.0, 1_609_459_200.0),
    ],
)
def test_logs_of_other_programs_are_read(
    case: Path, tmp_path: Path, name: str, seconds: float, last: float
) -> None:
    """All 20 frames at their own times."""
    run = replayed(copied(case, "unreadable-format-silent", "gvret.csv", name), tmp_path)
    times_s = [row["t_ns"] * 1e-9 for row in run.topic("odometer")]
    assert len(times_s) == 20
    assert times_s[0] == pytest.approx(last, abs=1e-6)
    assert times_s[-1] - times_s[0] == pytest.approx(seconds, abs=1e-6)
    assert run.topic("odometer")[0]["speed_mps"] == pytest.approx(50.0 / 3.6)


@pytest.mark.parametrize(
    ("text", "name", "mend"),
    [
        (
            "  can0  123   [8]  88 13 B8 0B 00 00 00 00\n",
            "screen output without times",
            "candump -l",
        ),
        ("@ TEXT @ 3 @ 64 @ 0 @\n27,3\t1\t04\t3D8\n", "CARBUS Analyzer", "candump -l"),
        ("ID,D0,D1\n123,88,13\n", "without times", "candump -l"),
        ("$GPGGA,135901.00,,,,,0,00,,,M,,M,,*7A\n", "NMEA 0183", "[[nmea]]"),
        ("what is this\n" * 9, "not one of its 9 lines", "give a CAN recording"),
        ("", "is empty", "another recording"),
        ("\0" * 4096, "nothing but zeros", "another recording"),
    ],
)
def test_what_is_not_read_is_refused_by_name(
    case: Path, tmp_path: Path, text: str, name: str, mend: str
) -> None:
    """In one line, with the mend."""
    drive = copied(case, "unreadable-format-silent", "gvret.csv", "x.log")
    (drive / "x.log").write_text(text, encoding="ascii")
    said = replayed(drive, tmp_path).said
    assert "x.log" in said
    assert name in said
    assert mend in said


def test_the_doctor_refuses_alike(tmp_path: Path) -> None:
    """What cannot be read is no sleeping bus."""
    path = tmp_path / "x.log"
    path.write_text("what is this\n" * 9, encoding="ascii")
    said = invoked(tmp_path, "doctor", "can", "--log", str(path)).said
    assert "not one of its 9 lines" in said
    own = CASES / "all-tx-silent" / "a.asc"
    assert (
        "100 frames sent by the logger"
        in invoked(tmp_path, "doctor", "can", "--log", str(own)).said
    )


def test_a_channel_is_what_the_file_calls_it(case: Path, tmp_path: Path) -> None:
    """CANoe counts from 1."""
    assert len(replayed(CASES / "asc-channel-number", tmp_path).topic("odometer")) == 100
    drive = copied(case, "asc-channel-number", 'channel = "1"', "channel = 0")
    said = replayed(drive, tmp_path).said
    assert "no frame on that channel" in said
    assert "('1')" in said


def test_frames_of_the_logger_itself_are_said_and_can_be_taken(case: Path, tmp_path: Path) -> None:
    """All of them are marked Tx."""
    said = replayed(CASES / "all-tx-silent", tmp_path).said
    assert "100 frames sent by the logger itself (Tx) left out" in said
    assert "own_frames = true" in said
    drive = copied(case, "all-tx-silent", "dbc =", "own_frames = true\ndbc =")
    run = replayed(drive, tmp_path)
    assert len(run.topic("odometer")) == 100
    assert "100 frames taken that the logger sent itself" in run.out


@pytest.mark.parametrize(
    ("name", "reason"),
    [("decoded.mf4", "holds no raw CAN frames"), ("cut.mf4", "cannot be read")],
)
def test_an_mf4_without_frames_is_one_line(
    case: Path, tmp_path: Path, name: str, reason: str
) -> None:
    """No traceback under it either."""
    drive = copied(case, "mf4-silent", "decoded.mf4", name)
    assert reason in ended(tmp_path, "replay", str(drive), "--out", str(tmp_path / "out")).said


def test_a_dbc_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    assert len(replayed(CASES / "dbc-bom", tmp_path).topic("odometer")) == 4


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-8", "cp1252"])
def test_a_dbc_is_read_in_any_encoding(case: Path, tmp_path: Path, encoding: str) -> None:
    """Of a unit that is no ASCII."""
    drive = copied(case, "dbc-bom")
    text = (drive / "v.dbc").read_text(encoding="utf-8-sig").replace("rpm", "°C")
    (drive / "v.dbc").write_text(text, encoding=encoding)
    assert len(replayed(drive, tmp_path).topic("odometer")) == 4


def test_a_name_that_a_dbc_has_twice_is_refused(case: Path, tmp_path: Path) -> None:
    """Which of them was meant nobody knows."""
    drive = copied(case, "dbc-bom")
    text = (drive / "v.dbc").read_text(encoding="utf-8-sig").replace("CCVS", "SPD")
    (drive / "v.dbc").write_text(text, encoding="utf-8")
    assert "message SPD, of which a dbc has several (123h, 18FEF1FEh)" in (
        replayed(drive, tmp_path).said
    )


def with_receiver(folder: Path) -> str:
    """An `[[nmea]]` of 16 April 2020."""
    text = "".join(RMC.format(second, second) for second in range(1, 9))
    (folder / "g.nmea").write_text(text, encoding="ascii")
    return NMEA_SOURCE


def test_a_recording_without_a_date_is_refused_beside_a_dated_source(tmp_path: Path) -> None:
    """Unless its day or its offset is given; alone it is said."""
    path = recording("microchip", tmp_path)
    said = replayed(drive_of(tmp_path, path, sources=with_receiver(tmp_path)), tmp_path).said
    assert "carries no date" in said
    assert "clock_offset_s" in said
    for option, start_s in (
        ("date = 2020-04-16", 1_586_995_200.0),
        ("clock_offset_s = 1587045541.0", START_S),
    ):
        drive_of(tmp_path, path, options=option, sources=with_receiver(tmp_path))
        run = replayed(tmp_path, tmp_path)
        assert run.topic("odometer")[0]["t_ns"] * 1e-9 == pytest.approx(start_s + 166.064)
    run = replayed(drive_of(tmp_path, path), tmp_path)
    assert run.status == 0
    assert "warning" in run.out
    assert "carries no date" in run.out


def test_a_source_that_cannot_be_read_is_a_warning_beside_others(tmp_path: Path) -> None:
    """A receiver's log is worth a replay."""
    path = tmp_path / "x.log"
    path.write_text("what is this\n" * 9, encoding="ascii")
    run = replayed(drive_of(tmp_path, path, sources=with_receiver(tmp_path)), tmp_path)
    assert run.status == 0
    assert len(run.topic("gps_fix")) == 8
    assert "warning: " in run.out
    assert "not one of its 9 lines" in run.out


def test_frames_that_nothing_maps_are_an_error_and_counted_beside_others(tmp_path: Path) -> None:
    """With the identifiers that there are."""
    path = recording("candump", tmp_path)
    drive = drive_of(tmp_path, path)
    assert "left out, can-ingest: not mapped" in replayed(drive, tmp_path).out
    (tmp_path / "v.dbc").write_text(
        'VERSION ""\nBU_: X\nBO_ 77 SPD: 8 X\n SG_ Speed : 0|16@1+ (1,0) [0|1] "km/h" X\n'
    )
    said = replayed(drive, tmp_path).said
    assert "none of its frames is mapped (it has 123, 18FEF100)" in said


def test_an_nmea_log_without_a_sentence_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "drive.toml").write_text(f'[drive]\nvehicle_id = "t"\n{NMEA_SOURCE}')
    (tmp_path / "g.nmea").write_text("nothing\n")
    assert "holds no NMEA 0183 sentence" in replayed(tmp_path, tmp_path).said


def test_reports_without_a_place_are_an_error(tmp_path: Path) -> None:
    (tmp_path / "drive.toml").write_text(
        '[drive]\nvehicle_id = "t"\n[[avl]]\npath = "a.csv"\n'
        'columns = { time = "t", lat_deg = "y", lon_deg = "x" }\n'
    )
    (tmp_path / "a.csv").write_text("t,y,x\n2020-04-16 13:59:01,,\n")
    assert "none of its 1 rows" in replayed(tmp_path, tmp_path).said


def test_playing_what_cannot_be_read_is_refused(tmp_path: Path) -> None:
    """Before anything is played."""
    done = subprocess.run(
        [COMMAND.with_name("wayline-can-ingest"), "--drive", CASES / "all-tx-silent"],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "own_frames = true" in done.stderr


def test_an_outage_behind_the_end_is_refused_before_the_work(tmp_path: Path) -> None:
    run = replayed(CASES / "asc-header-date", tmp_path, "--gps-outage", "900:10")
    assert "begins behind the drive's end, which is at 10.0 s" in run.said
    assert not run.folder.exists()


@pytest.mark.parametrize(("name", "reason"), [("no/a.png", "no folder"), ("a.xyz", "picture")])
def test_a_plot_that_cannot_be_written_is_refused_before_the_work(
    tmp_path: Path, name: str, reason: str
) -> None:
    drive = CASES / "asc-header-date"
    run = invoked(tmp_path, "evaluate", "accuracy", str(drive), "--plot", str(tmp_path / name))
    assert reason in run.said
