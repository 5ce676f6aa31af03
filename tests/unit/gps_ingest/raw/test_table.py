"""Raw measurements are read by their table; what a row cannot mean is seen, not guessed."""

import gzip
from pathlib import Path

import pytest

from wayline.drive import AvlColumn, Drive, DriveInfo, RawColumns, RawSource
from wayline.errors import InputError
from wayline.messages import GpsRaw, RawSatellite
from wayline_gps_ingest.raw.epoch import RawEpoch
from wayline_gps_ingest.raw.table import RawTable
from wayline_gps_ingest.recorded import recordings

HEADER = "t,system,prn,range,std,x,y,z,cn0,los\n"
COLUMNS = RawColumns(
    time="t",
    system="system",
    prn="prn",
    pseudorange_m="range",
    pseudorange_std_m="std",
    x_m="x",
    y_m="y",
    z_m="z",
    cn0_dbhz="cn0",
    line_of_sight="los",
)
PLACE = "14567933.9,2809850.9,21875628.1"
T_NS = 1_400_000_000_000_000_000


def source(folder: Path, text: str, columns: RawColumns = COLUMNS) -> RawSource:
    path = folder / "raw.csv"
    path.write_text(text, encoding="utf-8")
    return RawSource(path=str(path), columns=columns)


def table(folder: Path, rows: str) -> RawTable:
    return RawTable(source(folder, HEADER + rows), COLUMNS)


def only(folder: Path, row: str) -> RawSatellite:
    (epoch,) = table(folder, row)
    (satellite,) = epoch.satellites
    return satellite


def test_rows_of_one_instant_are_an_epoch(tmp_path: Path) -> None:
    rows = (
        f"1400000000.0,gps,12,19949087.65,5.0,{PLACE},49,\n"
        f"1400000000.0,glonass,320,19713469.0,8.0,{PLACE},40,\n"
        f"1400000000.2,gps,12,19949090.0,5.0,{PLACE},49,\n"
    )
    first, second = table(tmp_path, rows)
    assert [(each.system, each.prn) for each in first.satellites] == [("gps", 12), ("glonass", 320)]
    assert (first.t_ns, second.t_ns) == (T_NS, T_NS + 200_000_000)
    assert first.satellites[0] == RawSatellite(
        system="gps",
        prn=12,
        pseudorange_m=19949087.65,
        pseudorange_std_m=5.0,
        cn0_dbhz=49.0,
        x_m=14567933.9,
        y_m=2809850.9,
        z_m=21875628.1,
    )


def test_rows_may_be_out_of_order_by_two_seconds(tmp_path: Path) -> None:
    """A file sorted by satellite within its blocks."""
    times = ("0.0", "1.0", "0.0", "1.0")
    rows = "".join(
        f"140000000{time},gps,{12 + at // 2},2e7,5,{PLACE},49,\n" for at, time in enumerate(times)
    )
    first, second = table(tmp_path, rows)
    assert [len(epoch.satellites) for epoch in (first, second)] == [2, 2]
    assert second.t_ns - first.t_ns == 10**9


def test_a_row_of_an_epoch_that_is_over_is_late(tmp_path: Path) -> None:
    times = ("0", "9", "1")
    read = table(
        tmp_path, "".join(f"140000000{time},gps,12,2e7,5,{PLACE},49,\n" for time in (*times, "9"))
    )
    assert [epoch.t_ns - T_NS for epoch in read] == [0, 10**9, 9 * 10**9]
    assert read.faults == {"twice": 1}
    late = table(
        tmp_path,
        "".join(f"14000000{time},gps,12,2e7,5,{PLACE},49,\n" for time in ("00", "05", "09", "01")),
    )
    assert [epoch.t_ns - T_NS for epoch in late] == [0, 5 * 10**9, 9 * 10**9]
    assert late.faults == {"late": 1}


@pytest.mark.parametrize(
    ("row", "fault"),
    [
        (f"yesterday,gps,12,2e7,5,{PLACE},49,", "row"),
        (f"1400000000,,twelve,2e7,5,{PLACE},49,", "row"),
        (f"1400000000,loran,12,2e7,5,{PLACE},49,", "row"),
        ("1400000000", "row"),
        (f"1400000000,gps,12,,5,{PLACE},49,", "empty"),
        (f"1400000000,gps,12,0,5,{PLACE},49,", "empty"),
        (f"1400000000,gps,12,nan,5,{PLACE},49,", "empty"),
        (f"1400000000,gps,12,1e12,5,{PLACE},49,", "empty"),
    ],
)
def test_a_row_that_measures_nothing_is_counted(tmp_path: Path, row: str, fault: str) -> None:
    read = table(tmp_path, f"{row}\n1400000001,gps,12,2e7,5,{PLACE},49,\n")
    assert [epoch.t_ns for epoch in read] == [T_NS + 10**9]
    assert read.faults == {fault: 1}


@pytest.mark.parametrize(
    ("row", "unknown"),
    [
        (f"gps,12,2e7,0,{PLACE},49,", ("pseudorange_std_m",)),
        (f"gps,12,2e7,5,{PLACE},0,", ("cn0_dbhz",)),
        ("gps,12,2e7,5,0,0,0,49,", ("x_m", "y_m", "z_m")),
        ("gps,12,2e7,5,14567933.9,,21875628.1,49,", ("x_m", "y_m", "z_m")),
        ("gps,12,2e7,5,1e9,1e9,1e9,49,", ("x_m", "y_m", "z_m")),
    ],
)
def test_what_stands_for_unknown_is_unknown(
    tmp_path: Path, row: str, unknown: tuple[str, ...]
) -> None:
    satellite = only(tmp_path, f"1400000000,{row}\n")
    told = ("pseudorange_m", "pseudorange_std_m", "cn0_dbhz", "x_m", "y_m", "z_m")
    assert tuple(name for name in told if getattr(satellite, name) is None) == unknown


@pytest.mark.parametrize(
    ("system", "prn", "named"),
    [
        ("GPS", "12", ("gps", 12)),
        ("", "G12", ("gps", 12)),
        ("", "12", ("gps", 12)),
        ("", "E05", ("galileo", 5)),
        ("C", "30", ("beidou", 30)),
        ("Galileo", "E5", ("galileo", 5)),
        ("IRNSS", "3.0", ("navic", 3)),
    ],
)
def test_satellites_have_several_names(
    tmp_path: Path, system: str, prn: str, named: tuple[str, int]
) -> None:
    satellite = only(tmp_path, f"1400000000,{system},{prn},2e7,5,{PLACE},49,\n")
    assert (satellite.system, satellite.prn) == named


@pytest.mark.parametrize(
    ("text", "seen"), [("1", True), ("nlos", False), ("False", False), ("", None), ("maybe", None)]
)
def test_the_line_of_sight_is_told_where_the_table_tells_it(
    tmp_path: Path, text: str, seen: bool | None
) -> None:
    assert only(tmp_path, f"1400000000,gps,12,2e7,5,{PLACE},49,{text}\n").line_of_sight is seen


def test_columns_may_be_in_another_unit(tmp_path: Path) -> None:
    columns = RawColumns(time="t", prn="p", doppler_hz=AvlColumn(name="rate", scale=-5.255))
    (epoch,) = RawTable(source(tmp_path, "t;p;rate\n1400000000;G3;100,5\n", columns), columns)
    assert epoch.satellites[0].doppler_hz == pytest.approx(-528.1275)
    assert epoch.satellites[0].pseudorange_m is None


def test_a_table_that_is_cut_is_read_up_to_there(tmp_path: Path) -> None:
    rows = HEADER + "".join(f"{1400000000 + n},gps,12,2e7,5,{PLACE},49,\n" for n in range(2000))
    path = tmp_path / "raw.csv.gz"
    path.write_bytes(gzip.compress(rows.encode())[:-200])
    read = RawTable(RawSource(path=str(path), columns=COLUMNS), COLUMNS)
    assert 500 < sum(1 for _ in read) < 2000
    assert read.faults["broken"] == 1


def drive_of(raw: RawSource) -> Drive:
    return Drive(drive=DriveInfo(vehicle_id="car"), raw=(raw,))


def test_a_column_that_is_not_there_is_refused_with_those_that_are(tmp_path: Path) -> None:
    raw = source(tmp_path, "t,prn,rho\n", RawColumns(time="t", prn="prn", pseudorange_m="range"))
    (recording,) = recordings(drive_of(raw), "drive.toml")
    with pytest.raises(InputError, match=r"no column range for pseudorange_m.*: t, prn, rho"):
        list(recording.messages)


def test_a_table_of_which_nothing_is_read_says_why(tmp_path: Path) -> None:
    raw = source(tmp_path, HEADER + f"1400000000,gps,12,,5,{PLACE},49,\n" * 3)
    (recording,) = recordings(drive_of(raw), "drive.toml")
    assert list(recording.messages) == []
    assert "none of its 3 rows measures a satellite (3 empty)" in str(recording.nothing())


def test_a_table_sorted_by_satellite_says_how_to_sort_it(tmp_path: Path) -> None:
    rows = [f"{1400000000 + n},,G{prn},2e7,5,{PLACE},49,\n" for prn in (5, 7) for n in range(20)]
    raw = source(tmp_path, HEADER + "".join(rows))
    told = RawSource(path=raw.path, columns=COLUMNS, corrected=("satellite_clock", "atmosphere"))
    (recording,) = recordings(drive_of(told), "drive.toml")
    assert len(list(recording.messages)) == 20
    (warning,) = recording.account().warnings
    assert "rows come over 2 s after later ones and are left out; sort it by time" in warning


def test_satellites_clocks_that_nobody_tells_are_warned_of(tmp_path: Path) -> None:
    raw = source(tmp_path, HEADER + f"1400000000,gps,12,2e7,5,{PLACE},49,\n")
    (recording,) = recordings(drive_of(raw), "drive.toml")
    assert len(recording.account().warnings) == 1
    told = RawSource(path=raw.path, columns=COLUMNS, corrected=("satellite_clock",))
    (recording,) = recordings(drive_of(told), "drive.toml")
    assert recording.account().warnings == ()


def test_a_recorded_drive_of_raw_measurements_alone_makes_messages(tmp_path: Path) -> None:
    rows = "".join(f"{1400000000 + n},gps,12,{2e7 + n},5,{PLACE},49,\n" for n in range(20))
    (recording,) = recordings(drive_of(source(tmp_path, HEADER + rows)), "drive.toml")
    messages = [message for _, message in recording.messages]
    assert [type(each) for each in messages] == [GpsRaw] * 20
    assert (recording.source, recording.bad_input()) == ("gps-ingest", 0)
    assert isinstance(next(iter(RawTable(source(tmp_path, HEADER + rows), COLUMNS))), RawEpoch)
