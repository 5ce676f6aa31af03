"""Logs as receivers, links and loggers write them, through `wayline replay` to fixes."""

import gzip
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from unit.gps_ingest.receiver import gga, line, rmc
from wayline.errors import InputError
from wayline_replay.replay import replay

LOGS = Path(__file__).parent / "logs"


class Replayed(NamedTuple):
    """The fixes of a drive and what was counted and dropped."""

    fixes: list[dict[str, Any]]
    bad_input: int


def replayed(drive: Path, out: Path) -> Replayed:
    summary = replay(drive, out)
    topic = out / "gps_fix.jsonl"
    lines = topic.read_bytes().splitlines() if topic.exists() else []
    return Replayed([json.loads(line) for line in lines], sum(summary.bad_input.values()))


@pytest.fixture
def log(tmp_path: Path) -> Callable[..., Replayed]:
    """Replays a log of these bytes."""

    def run(content: bytes, more: str = "", name: str = "g.nmea") -> Replayed:
        drive = tmp_path / "drive"
        drive.mkdir()
        (drive / name).write_bytes(content)
        table = f'[drive]\nvehicle_id = "t"\n[[nmea]]\npath = "{name}"\n{more}'
        (drive / "drive.toml").write_text(table, encoding="utf-8")
        return replayed(drive, tmp_path / "out")

    return run


def text(*sentences: str) -> bytes:
    return "".join(f"{sentence}\r\n" for sentence in sentences).encode()


def valid(of: Replayed) -> list[dict[str, Any]]:
    return [fix for fix in of.fixes if fix["valid"]]


def test_a_zda_with_the_time_of_its_sending_splits_no_epoch(tmp_path: Path) -> None:
    """It stands between the GGA and RMC of one instant, as Trimble's R1 sends it."""
    fixes, bad_input = replayed(LOGS / "zda-own-time", tmp_path)
    assert bad_input == 0
    assert [fix["t_ns"] for fix in fixes] == [1457650570 * 10**9 + n * 10**9 for n in range(10)]
    for fix in fixes:
        assert fix["speed_mps"] == pytest.approx(12.0 * 1852.0 / 3600.0)
        assert not fix.get("speed_derived")
        told = fix["course_deg"], fix["mode"], fix["pdop"], fix["hdop"]
        assert told == (231.1, 2, 4.4, 4.2)


def test_sentences_out_of_order_keep_their_own_times(tmp_path: Path) -> None:
    """A 4 Hz log whose RMC .500 comes before RMC .000; what comes too late is left out."""
    fixes, bad_input = replayed(LOGS / "out-of-order-4hz", tmp_path)
    start_ns = 1187343116 * 10**9
    assert bad_input == 14
    assert len(fixes) == 21
    for fix in fixes:
        since_s = (fix["t_ns"] - start_ns) / 1e9
        assert since_s % 0.25 == 0.0
        assert fix["lat_deg"] == pytest.approx(48.0 + since_s * 20.0 / 111120.0, abs=1e-6)


def test_a_torn_sentence_does_not_overrule_a_whole_one(tmp_path: Path) -> None:
    """The checksum of a GGA that lost its middle is right by chance."""
    fixes, bad_input = replayed(LOGS / "torn-gga-overrules", tmp_path)
    assert ([fix["valid"] for fix in fixes], bad_input) == ([True], 1)


PLACE = "4807.038,N,01131.000,E"
HOLDS = [rmc("120000"), gga("120000")]


@pytest.mark.parametrize(
    "unknown",
    [
        [gga("120001", position="0000.000,N,00000.000,E")],
        [rmc("120001", position="0000.0000,S,00000.0000,W")],
        [line(f"GPRMC,120001,A,{PLACE},022.4,084.4,230394,,,N")],
        [line(f"GPRMC,120001,V,{PLACE},022.4,084.4,230394,,,A")],
        [gga("120001"), line(f"GPGLL,{PLACE},120001,A,N")],
        [gga("120001", quality=0), rmc("120001")],
        [line(f"GNGNS,120001,{PLACE},NN,00,99.9,,,,")],
    ],
)
def test_a_place_that_is_unknown_or_denied_is_no_fix(
    log: Callable[..., Replayed], unknown: list[str]
) -> None:
    """0 N 0 E, a status and a mode that contradict each other, one sentence against another."""
    found = log(text(*HOLDS, *unknown, rmc("120002")))
    assert [fix["valid"] for fix in found.fixes] == [True, False, True]
    assert found.bad_input == 0


@pytest.mark.parametrize(
    "torn",
    [
        f"GPRMC,120001,A,{PLACE},022.4",
        "GPGGA,120001,4807.038,N,01131.000,E,M,46.9,M,,",
        "GPGGA,120001,4807.038,N,01131.000,E,1,08,545.4,M,46.9,M,,",
        "GPRMC,120001,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
        "GPGLL,4807.038,N,01131.000",
        "GPGST,120001,5.0,,,",
    ],
)
def test_a_sentence_with_a_right_checksum_and_fields_that_are_missing_is_counted(
    log: Callable[..., Replayed], torn: str
) -> None:
    found = log(text(*HOLDS, line(torn), rmc("120002")))
    assert [fix["valid"] for fix in found.fixes] == [True, True]
    assert found.bad_input == 1


def test_fields_padded_with_blanks_are_read(log: Callable[..., Replayed]) -> None:
    """As receivers with columns of fixed width write them."""
    padded = line("GPRMC,120000 , A, 4807.038,N,01131.000 ,E, 22.4, 84.4,230394,  3.1,W")
    (fix,) = log(text(padded)).fixes
    assert (fix["lat_deg"], fix["course_deg"]) == (pytest.approx(48.1173), 84.4)


def test_minutes_rounded_up_to_60_are_the_next_degree(log: Callable[..., Replayed]) -> None:
    (fix,) = log(text(rmc("120000", position="4860.0000,N,01160.0000,E"))).fixes
    assert (fix["lat_deg"], fix["lon_deg"]) == (49.0, 12.0)


def test_a_log_without_a_date_needs_one_and_takes_it(log: Callable[..., Replayed]) -> None:
    found = log(text(gga("235959"), gga("000000")), "date = 2026-11-22\n")
    assert [fix["t_ns"] for fix in found.fixes] == [1795391999 * 10**9, 1795392000 * 10**9]


@pytest.mark.parametrize("date", ["", "000000", "060180"])
def test_a_log_without_a_date_is_refused(log: Callable[..., Replayed], date: str) -> None:
    """Zeros and 1980 are what a receiver writes that has not heard the date."""
    with pytest.raises(InputError, match=r"no sentence carries a date; add date = YYYY-MM-DD"):
        log(text(gga("120000"), rmc("120000", date=date)))


def test_a_log_of_gpsds_reports_is_read(log: Callable[..., Replayed]) -> None:
    """As `gpspipe -w` writes it; an old gpsd tells the altitude as `alt`."""
    found = log((LOGS / "gpsd-old-alt" / "gpsd.jsonl").read_bytes(), name="gpsd.jsonl")
    assert [(fix["valid"], fix["alt_m"]) for fix in found.fixes] == [(True, 449.5)] * 2
    assert found.bad_input == 0


@pytest.mark.parametrize("name", ["g.nmea", "gpsd.jsonl"])
def test_a_packed_log_that_was_cut_is_read_so_far_and_counted(
    log: Callable[..., Replayed], name: str
) -> None:
    """Power went before the logger could close its file."""
    gpsd = (
        f'{{"class":"TPV","mode":2,"time":"2026-11-30T01:{minute:02d}:{second:02d}Z",'
        f'"lat":48.1,"lon":11.5,"speed":{second}.{minute}}}\n'
        for minute in range(60)
        for second in range(60)
    )
    nmea = (
        f"{rmc(f'12{minute:02d}{second:02d}')}\n" for minute in range(60) for second in range(60)
    )
    packed = gzip.compress("".join(nmea if name == "g.nmea" else gpsd).encode())
    found = log(packed[: len(packed) // 2], name=name)
    assert 600 < len(found.fixes) < 3000
    assert found.bad_input in (1, 2)  # the line that was cut too


def test_a_drive_file_may_have_a_byte_order_mark(tmp_path: Path) -> None:
    """As Windows' editor saves it."""
    (tmp_path / "g.nmea").write_bytes(text(rmc("120000")))
    table = '[drive]\nvehicle_id = "t"\n[[nmea]]\npath = "g.nmea"\n'
    (tmp_path / "drive.toml").write_text(table, encoding="utf-8-sig")
    assert len(replayed(tmp_path, tmp_path / "out").fixes) == 1
