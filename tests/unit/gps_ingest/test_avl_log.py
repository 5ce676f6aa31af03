"""Position reports are read by their table; bad rows are seen, bad tables refused."""

import gzip
from pathlib import Path

import msgspec
import pytest

from wayline.avl_log import read_reports
from wayline.drive import AvlColumns, AvlSource
from wayline.errors import InputError
from wayline.inputs import PositionReport

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
    columns = msgspec.structs.replace(table.columns, time="Zeit")
    assert list(read_reports(msgspec.structs.replace(table, columns=columns))) == [REPORT]


def test_a_packed_table_that_was_cut_is_read_so_far_and_counted(tmp_path: Path) -> None:
    packed = gzip.compress((HEADER + "1462459510,38.9,-77.0,,\n" * 10_000).encode())
    table = source(tmp_path, "")
    Path(table.path).write_bytes(packed[: len(packed) * 3 // 4])
    *reports, last = read_reports(table)
    assert sum(report is not None for report in reports) > 5_000
    assert last is None
