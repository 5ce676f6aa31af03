"""What CAN recordings say of their times and channels, format by format."""

import datetime as dt
from pathlib import Path

import pytest

from wayline.can_log import CanLog
from wayline.errors import InputError
from wayline.inputs import Frame

APRIL_S = 1_587_045_541.0
"""16 April 2020, 13:59:01 UTC."""
FRAME = "   {:.6f} 1  123             Rx   d 8 88 13 B8 0B 00 00 00 00\n"
BLOCK = "Begin TriggerBlock {}\n"


def read(folder: Path, name: str, text: str, **options: object) -> list[Frame]:
    """Frames of a recording with this text."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return list(CanLog([path], **options))  # type: ignore[arg-type]


def times_s(frames: list[Frame]) -> list[float]:
    """In seconds since the header's date."""
    return [round(frame.t_ns * 1e-9 - APRIL_S, 6) for frame in frames]


@pytest.mark.parametrize(
    "date",
    [
        "Thu Apr 16 01:59:01.000 pm 2020",
        "Thu Apr 16 01:59:01 PM 2020",
        "Thu Apr 16 13:59:01.000 2020",
        "Do. April 16 13:59:01 2020",
        "Apr 16 13:59:01.000000 2020",
    ],
)
def test_an_asc_counts_from_its_headers_date(tmp_path: Path, date: str) -> None:
    """English and German, with twelve hours and with 24."""
    text = f"date {date}\nbase hex  timestamps absolute\n" + FRAME.format(0.5)
    assert times_s(read(tmp_path, "a.asc", text)) == [0.5]


@pytest.mark.parametrize(("month", "number"), [("Mär", 3), ("Mai", 5), ("Okt", 10), ("Dez", 12)])
def test_a_german_month_is_known(tmp_path: Path, month: str, number: int) -> None:
    """As CANoe writes it, in Windows' code page."""
    text = f"date Fre {month} 02 13:59:01 2020\nbase hex  timestamps absolute\n" + FRAME.format(0)
    (tmp_path / "a.asc").write_bytes(text.encode("cp1252"))
    (frame,) = CanLog([tmp_path / "a.asc"])
    assert dt.datetime.fromtimestamp(frame.t_ns * 1e-9, dt.UTC).month == number


def test_noon_and_midnight_of_a_twelve_hour_clock(tmp_path: Path) -> None:
    """12 am is 0 h, 12 pm is 12 h."""
    for half, hour in (("am", 0), ("pm", 12)):
        text = f"date Thu Apr 16 12:00:00.000 {half} 2020\nbase hex  timestamps absolute\n"
        (frame,) = read(tmp_path, "a.asc", text + FRAME.format(0))
        assert dt.datetime.fromtimestamp(frame.t_ns * 1e-9, dt.UTC).hour == hour


def test_every_block_of_an_asc_counts_from_its_own_or_the_headers_date(tmp_path: Path) -> None:
    """Whichever is nearer to its trigger: loggers write either."""
    head = "date Thu Apr 16 13:59:01.000 2020\nbase hex  timestamps absolute\n"
    first = BLOCK.format("Thu Apr 16 13:59:01.000 2020") + FRAME.format(0.1)
    later = BLOCK.format("Thu Apr 16 14:00:01.000 2020")
    going_on = head + first + later + FRAME.format(60.1)
    anew = head + first + later + FRAME.format(0.1)
    assert times_s(read(tmp_path, "a.asc", going_on)) == [0.1, 60.1]
    assert times_s(read(tmp_path, "b.asc", anew)) == [0.1, 60.1]


def test_relative_times_count_other_events_too(tmp_path: Path) -> None:
    """A line of statistics lies between two frames."""
    text = "date Thu Apr 16 13:59:01.000 2020\nbase hex  timestamps relative\n"
    text += FRAME.format(0.1) + "   0.400000 1  Statistic: D 1 R 0 XD 0 XR 0 E 0 O 0 B 0.1%\n"
    assert times_s(read(tmp_path, "a.asc", text + FRAME.format(0.1))) == [0.1, 0.6]


def test_an_asc_loses_no_frame_behind_a_short_header(tmp_path: Path) -> None:
    """Its decimal base is kept, too."""
    text = "base dec  timestamps absolute\n   0.1 1  291  Rx   d 2 136 19\n"
    (frame,) = read(tmp_path, "a.asc", text)
    assert (frame.arbitration_id, frame.data, frame.t_ns) == (291, b"\x88\x13", 100_000_000)


def test_a_time_zone_holds_for_wall_clocks_only(tmp_path: Path) -> None:
    """candump writes Unix time; its -t A is by the wall."""
    zone = {"timezone": "America/New_York"}
    unix = read(tmp_path, "a.log", f"({APRIL_S:.6f}) can0 123#88\n", **zone)
    screen = " (2020-04-16 09:59:01.500000)  can0  123   [1]  88\n"
    assert times_s(unix) == [0.0]
    assert times_s(read(tmp_path, "b.log", screen, **zone)) == [0.5]
    with pytest.raises(InputError, match="unknown timezone 'Mars'"):
        read(tmp_path, "a.log", "", timezone="Mars")


def test_a_day_given_is_where_the_times_of_an_undated_recording_begin(tmp_path: Path) -> None:
    """At midnight in its time zone; a recording with a date needs none."""
    day = dt.date(2020, 4, 16)
    text = "(50341.000000) can0 123#88\n"
    assert times_s(read(tmp_path, "a.log", text, date=day)) == [0.0]
    assert times_s(read(tmp_path, "a.log", text, date=day, timezone="Europe/Berlin")) == [-7200.0]
    dated = f"({APRIL_S:.6f}) can0 123#88\n"
    assert times_s(read(tmp_path, "b.log", dated, date=dt.date(2021, 1, 1))) == [0.0]


TRC = {
    "1.0": "      1)      100.5  0123  2  88 13 \n",
    "1.1": "      1)      100.5  Rx         0123  2  88 13 \n",
    "1.2": "      1)      100.500 1  Rx        0123  2  88 13 \n",
    "1.3": "      1)      100.500 1  Rx        0123 -  2    88 13 \n",
    "2.0": "      1      100.500 DT     0123 Rx 2  88 13 \n",
    "2.1": "      1      100.500 DT 1     0123 Rx -  2    88 13 \n",
}
COLUMNS = {"2.0": "N,O,T,I,d,l,D", "2.1": "N,O,T,B,I,d,R,l,D"}


@pytest.mark.parametrize("version", TRC)
def test_every_version_of_a_trc_is_read(tmp_path: Path, version: str) -> None:
    """1.0 tells no date."""
    head = "" if version == "1.0" else f";$FILEVERSION={version}\n;$STARTTIME=43937.5826504629\n"
    head += f";$COLUMNS={COLUMNS[version]}\n" if version in COLUMNS else ";\n"
    (frame,) = read(tmp_path, "a.trc", head + TRC[version])
    assert (frame.arbitration_id, frame.data) == (0x123, b"\x88\x13")
    start_s = 0.0 if version == "1.0" else APRIL_S
    assert frame.t_ns * 1e-9 == pytest.approx(start_s + 0.1005, abs=1e-4)


def test_an_unknown_version_of_a_trc_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"version 3\.0, not read"):
        read(tmp_path, "a.trc", ";$FILEVERSION=3.0\n" + TRC["2.1"])


def test_busmaster_goes_on_over_midnight_and_knows_its_modes(tmp_path: Path) -> None:
    """Times of day, since the start, since the line before; decimal numbers where it says so."""
    head = "***BUSMASTER Ver 3.2.2***\n***START DATE AND TIME 16:4:2020 23:59:59:000***\n"
    line = "{} Rx 1 {} s 1 {}\n"
    day = head + "***HEX***\n***SYSTEM MODE***\n"
    day += line.format("23:59:59:9000", "0x123", "88") + line.format("00:00:00:1000", "0x123", "88")
    late_s = 86_400.0 - 50_341.0
    assert times_s(read(tmp_path, "a.log", day)) == [late_s - 0.1, late_s + 0.1]
    for mode, last in (("ABSOLUTE", -0.8), ("RELATIVE", -0.7)):
        text = head + f"***DEC***\n***{mode} MODE***\n" + line.format("0:0:0:100", "291", "136")
        frames = read(tmp_path, "b.log", text + line.format("0:0:0:200", "291", "136"))
        assert times_s(frames) == [late_s - 0.9, late_s + last]
        assert (frames[0].arbitration_id, frames[0].data) == (291, b"\x88")


def test_a_recording_is_known_whatever_its_name(tmp_path: Path) -> None:
    """Also in capitals."""
    text = "date Thu Apr 16 13:59:01.000 2020\nbase hex  timestamps absolute\n" + FRAME.format(0.5)
    for name in ("A.ASC", "a.txt", "a"):
        assert times_s(read(tmp_path, name, text)) == [0.5]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_a_text_log_is_read_in_any_encoding(tmp_path: Path, encoding: str) -> None:
    text = "".join(f"({APRIL_S + number:.6f}) can0 123#88\n" for number in range(3))
    (tmp_path / "a.log").write_bytes(text.encode(encoding))
    assert times_s(list(CanLog([tmp_path / "a.log"]))) == [0.0, 1.0, 2.0]


def test_of_several_recordings_one_that_cannot_be_read_is_a_problem(tmp_path: Path) -> None:
    """The others are read."""
    (tmp_path / "a.log").write_text("what\n")
    (tmp_path / "b.log").write_text("(1.0) can0 123#88\n")
    log = CanLog([tmp_path / "a.log", tmp_path / "b.log"])
    assert len(list(log)) == 1
    assert "not one of its 1 lines" in str(log.problems[0])
