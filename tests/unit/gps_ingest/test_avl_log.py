"""Position reports are read by their table; bad rows are seen, bad tables refused."""

import gzip
from pathlib import Path

import msgspec
import pytest

from wayline.avl_log import ReportLog, read_reports
from wayline.drive import AvlColumn, AvlColumns, AvlSource
from wayline.errors import InputError
from wayline.inputs import PositionReport
from wayline_gps_ingest.reports import fix_of_report

HEADER = "time,lat,lon,heading,speed\n"


def source(folder: Path, text: str, timezone: str = "UTC") -> AvlSource:
    path = folder / "avl.csv"
    path.write_text(text, encoding="utf-8")
    columns = AvlColumns(
        time="time", lat_deg="lat", lon_deg="lon", heading_deg="heading", speed_mps="speed"
    )
    return AvlSource(path=str(path), columns=columns, timezone=timezone)


@pytest.mark.parametrize(
    ("time", "timezone", "t_ns"),
    [
        ("2016-05-05 10:45:09", "America/New_York", 1_462_459_509_000_000_000),
        ("2016-05-05T14:45:09.5Z", "America/New_York", 1_462_459_509_500_000_000),
        ("1462459509", "UTC", 1_462_459_509_000_000_000),
        ("1462459509250", "UTC", 1_462_459_509_250_000_000),
    ],
)
def test_times_are_local_or_say_what_they_are(
    tmp_path: Path, time: str, timezone: str, t_ns: int
) -> None:
    table = source(tmp_path, f"{HEADER}{time},38.9,-77.0,102,4.5\n", timezone)
    assert list(read_reports(table)) == [PositionReport(t_ns, 38.9, -77.0, 102.0, 4.5)]


def test_the_hour_that_summer_time_repeats_goes_on(tmp_path: Path) -> None:
    times = ("01:30:00", "01:59:59", "01:00:30", "02:00:00")
    rows = "".join(f"2016-11-06 {time},38.9,-77.0,,\n" for time in times)
    reports = list(read_reports(source(tmp_path, HEADER + rows, "America/New_York")))
    seconds = [(report.t_ns - 1_478_410_200_000_000_000) // 10**9 for report in reports if report]
    assert seconds == [0, 1799, 1830, 5400]


@pytest.mark.parametrize(
    "row",
    [
        "yesterday,38.9,-77.0,,",
        "1462459509,,-77.0,,",
        "1462459509,nan,-77.0,,",
        "1462459509",
        "1e300,38.9,-77.0,,",
        "9999-01-01,38.9,-77.0,,",
    ],
)
def test_a_bad_row_is_none_and_the_next_is_read(tmp_path: Path, row: str) -> None:
    good = "1462459510,38.9,-77.0,,\n"
    first, second = read_reports(source(tmp_path, f"{HEADER}{row}\n{good}"))
    assert first is None
    assert second == PositionReport(1_462_459_510_000_000_000, 38.9, -77.0)


@pytest.mark.parametrize(
    ("text", "timezone", "message"),
    [
        ("time,lat,longitude,heading,speed\n", "UTC", "no column lon for lon_deg; name one of"),
        ("", "UTC", "no column time for time_*.*the file is empty"),
        (HEADER, "Europe/Nowhere", "unknown timezone 'Europe/Nowhere'; give an IANA name"),
    ],
)
def test_a_table_that_does_not_fit_is_refused(
    tmp_path: Path, text: str, timezone: str, message: str
) -> None:
    with pytest.raises(InputError, match=message.replace("time_*", "time")):
        list(read_reports(source(tmp_path, text, timezone)))


def test_a_missing_file_is_said_in_one_line(tmp_path: Path) -> None:
    table = source(tmp_path, HEADER)
    Path(table.path).unlink()
    with pytest.raises(InputError, match="cannot be read"):
        list(read_reports(table))


ROWS = "Zeit;lat;lon;heading;speed\n22.11.2026 10:00:00;48,1000;11,5;102;4,5\n"
REPORT = PositionReport(1_795_341_600_000_000_000, 48.1, 11.5, 102.0, 4.5)


@pytest.mark.parametrize(
    "content",
    [
        ROWS.encode(),
        ROWS.encode("utf-8-sig"),
        ROWS.encode("utf-16"),
        ROWS.encode("utf-16-le"),
        gzip.compress(ROWS.encode()),
        ("sep=;\n" + ROWS).encode(),
        ("# Fahrzeug M\xfcnchen 1\n" + ROWS).encode("cp1252"),
        ROWS.replace(";", "\t").encode(),
        ROWS.replace(",", ".").replace(";", ",").encode(),
        ROWS.replace(";", '","')
        .replace("\n", '"\n')
        .replace("Zeit", '"Zeit')
        .replace("22", '"22')
        .encode(),
        ROWS.replace("22.11.2026", "2026/11/22").replace(";", "  |  ").encode(),
    ],
)
def test_tables_as_programs_export_them_are_read(tmp_path: Path, content: bytes) -> None:
    """Semicolons, tabs, decimal commas, packed, in the encodings of Excel."""
    table = source(tmp_path, "")
    Path(table.path).write_bytes(content)
    assert table.columns is not None
    columns = msgspec.structs.replace(table.columns, time="Zeit")
    assert list(read_reports(msgspec.structs.replace(table, columns=columns))) == [REPORT]


def test_a_packed_table_that_was_cut_is_read_so_far_and_counted(tmp_path: Path) -> None:
    packed = gzip.compress((HEADER + "1462459510,38.9,-77.0,,\n" * 10_000).encode())
    table = source(tmp_path, "")
    Path(table.path).write_bytes(packed[: len(packed) * 3 // 4])
    *reports, last = read_reports(table)
    assert sum(report is not None for report in reports) > 5_000
    assert last is None


def test_quality_assignment_and_other_units_are_read(tmp_path: Path) -> None:
    path = tmp_path / "avl.csv"
    path.write_text(
        "bus,time,lat,lon,kmh,sats,hdop,pdop,block\n"
        "7,1462459509,389000000,-77.0,36,9,0.9,1.8,SE-08\n"
        "8,1462459510,389000000,-77.0,36,9,0.9,1.8,SE-09\n"
        "7,1462459511,389000000,-77.0,,,,,\n"
    )
    columns = AvlColumns(
        time="time",
        lat_deg=AvlColumn(name="lat", scale=1e-7),
        lon_deg="lon",
        speed_mps=AvlColumn(name="kmh", scale=1.0 / 3.6),
        satellites="sats",
        hdop="hdop",
        pdop="pdop",
        assignment="block",
    )
    log = ReportLog(AvlSource(path=str(path), columns=columns, where={"bus": 7}))
    first, second = log
    assert first is not None
    assert second is not None
    assert first.lat_deg == pytest.approx(38.9)
    assert first.speed_mps == pytest.approx(10.0)
    assert (first.satellites, first.hdop, first.pdop) == (9.0, 0.9, 1.8)
    assert first.assignment == "SE-08"
    assert (second.satellites, second.pdop, second.assignment) == (None, None, None)
    assert log.left_out == 1


def test_a_condition_on_a_column_that_is_not_there_is_refused(tmp_path: Path) -> None:
    table = msgspec.structs.replace(source(tmp_path, HEADER), where={"bus": "7"})
    with pytest.raises(InputError, match="no column bus for where; name one of its columns: time"):
        list(read_reports(table))


def test_a_year_typed_wrong_changes_no_other_row(tmp_path: Path) -> None:
    """Not even in the hour that the end of summer time repeats."""
    times = ("2016-11-06 01:29:00", "2061-11-06 01:30:00", "2016-11-06 01:31:00")
    rows = "".join(f"{time},38.9,-77.0,,\n" for time in times)
    first, _, last = read_reports(source(tmp_path, HEADER + rows, "America/New_York"))
    assert first is not None
    assert last is not None
    assert last.t_ns - first.t_ns == 120 * 10**9


@pytest.mark.parametrize(
    ("told", "expected"),
    [
        ({"satellites": 7.0, "hdop": 0.8, "pdop": 1.7}, (7, 0.8, 1.7)),
        ({"satellites": -1.0, "hdop": 0.0, "pdop": -1.0}, (None, None, None)),
        ({"satellites": 1e300}, (None, None, None)),
    ],
)
def test_what_cannot_be_of_a_sky_is_unknown(
    told: dict[str, float], expected: tuple[int | None, float | None, float | None]
) -> None:
    fix = fix_of_report(msgspec.structs.replace(REPORT, **told))
    assert fix is not None
    assert (fix.satellites, fix.hdop, fix.pdop) == expected


def test_an_assignment_is_text_of_at_most_256_characters() -> None:
    for text, expected in (("SE-08", "SE-08"), ("x" * 257, None)):
        fix = fix_of_report(PositionReport(10**18, 38.9, -77.0, assignment=text))
        assert fix is not None
        assert fix.assignment == expected
