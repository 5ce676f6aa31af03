"""Logs are read whatever their line ends, times and noise."""

from pathlib import Path

import pytest

from unit.gps_ingest.receiver import gga, rmc
from wayline.errors import InputError
from wayline.inputs import Sentence
from wayline.nmea_log import has_date, read_sentences


def log(folder: Path, content: bytes) -> Path:
    path = folder / "gps.nmea"
    path.write_bytes(content)
    return path


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r\r\n", b"\r"])
def test_any_line_end(tmp_path: Path, end: bytes) -> None:
    path = log(tmp_path, b"$GPAAA,1*00" + end + b"$GPBBB,2*00" + end)
    assert [each.text for each in read_sentences(path)] == ["$GPAAA,1*00", "$GPBBB,2*00"]


def test_arrival_stands_before_the_sentence(tmp_path: Path) -> None:
    path = log(tmp_path, b"1558739321.022 $GPAAA,1*00\n1558739322 $GPBBB,2*00\n$GPCCC,3*00\n")
    assert list(read_sentences(path)) == [
        Sentence(1_558_739_321_022_000_000, "$GPAAA,1*00"),
        Sentence(1_558_739_322_000_000_000, "$GPBBB,2*00"),
        Sentence(None, "$GPCCC,3*00"),
    ]


def test_comments_and_binary_are_skipped(tmp_path: Path) -> None:
    path = log(tmp_path, b"# $GPAAA,0*00\n\xb5b\x01\x07\x00$x\n\x00$GPBBB,2*00\xb5b\x02$\n")
    assert [each.text for each in read_sentences(path)] == ["$GPBBB,2*00"]


@pytest.mark.parametrize(
    ("text", "dated"),
    [
        (rmc("120000"), True),
        (rmc("120000", date=""), False),
        (gga("120000"), False),
        ("$GPZDA,120000.00,04,07,2012,,*56", True),
        ("$GPZDA,,,,,,*48", False),
    ],
)
def test_a_date_is_found_without_reading_further(tmp_path: Path, text: str, dated: bool) -> None:
    assert has_date(log(tmp_path, text.encode() + b"\r\n")) is dated


def test_a_missing_log_is_said_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.nmea: cannot be read .*; check the path"):
        list(read_sentences(tmp_path / "none.nmea"))
