"""Logs are read whatever their line ends, times and noise."""

import codecs
import gzip
import tracemalloc
from pathlib import Path

import pytest

from unit.gps_ingest.receiver import gga, rmc
from wayline.errors import InputError
from wayline.inputs import Sentence
from wayline.nmea_log import NmeaLog, has_date, read_sentences


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


SENTENCES = "1558739321.5 $GPAAA,1*00\n$GPBBB,2*00\n"


@pytest.mark.parametrize(
    "content",
    [
        codecs.BOM_UTF8 + SENTENCES.encode(),
        SENTENCES.encode("utf-16"),
        SENTENCES.encode("utf-16-be"),
        gzip.compress(SENTENCES.encode()),
        gzip.compress(SENTENCES.encode("utf-16")),
        b"# caf\xe9\n" + SENTENCES.encode(),
    ],
)
def test_any_usual_encoding_is_read(tmp_path: Path, content: bytes) -> None:
    """Windows programs save UTF-16, editors put a byte order mark, loggers pack."""
    assert list(read_sentences(log(tmp_path, content))) == [
        Sentence(1_558_739_321_500_000_000, "$GPAAA,1*00"),
        Sentence(None, "$GPBBB,2*00"),
    ]


def test_what_a_packed_log_holds_before_its_damage_is_read(tmp_path: Path) -> None:
    """Power went before the logger could close its file."""
    texts = [f"$GPAAA,{number}*00" for number in range(20_000)]
    packed = gzip.compress("\n".join(texts).encode())
    torn = NmeaLog(log(tmp_path, packed[: len(packed) // 2]))
    told = [each.text for each in torn]
    assert told[:-1] == texts[: len(told) - 1]
    assert len(told) > 5_000
    assert torn.is_broken


def test_zeros_that_a_loss_of_power_left_fill_no_memory(tmp_path: Path) -> None:
    content = b"$GPAAA,1*00\n" + bytes(10_000_000) + b"\n$GPBBB,2*00\n"
    path = log(tmp_path, content)
    tracemalloc.start()
    assert [each.text for each in read_sentences(path)] == ["$GPAAA,1*00", "$GPBBB,2*00"]
    assert tracemalloc.get_traced_memory()[1] < 2_000_000
    tracemalloc.stop()
