"""Recorded receivers, against what the GPSD project expects of the same logs.

For the last TPV of each time with mode >= 2 and a position there must be a valid fix of that time
with latitude and longitude within 1e-6 degrees, altitude 0.1 m, speed 0.05 m/s, track 0.15
degrees. Reports of binary protocols are left out: a report counts when an NMEA sentence of the
log carries its time. Every remaining difference stands with its reason in
docs/gpsd-differences.md, which fails here when it is out of date.
"""

import datetime as dt
import json
import re
from collections import Counter
from collections.abc import Callable, Iterator
from functools import reduce
from operator import xor
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from unit.gps_ingest.receiver import fixes, replay
from wayline.messages import GpsFix

DIFFERENCES = Path(__file__).parents[2] / "docs" / "gpsd-differences.md"
MILLISECOND_NS = 1_000_000
TIMED = re.compile(rb"\$..(?:(?:GGA|RMC|GNS|ZDA),|GLL,[^,]*,.?,[^,]*,.?,)(?P<time>\d{6})")
CHECKED = re.compile(rb"[$!]([^$!*\r\n]*)\*([0-9A-Fa-f]{2})")

Report = dict[str, Any]


class Outcome(NamedTuple):
    """Every report of a log, and what differs at each."""

    reports: int
    differences: list[list[str]]
    """Per report; empty where all agrees."""


def content(log: Path) -> bytes:
    """The log without its comment lines."""
    lines = log.read_bytes().split(b"\n")
    return b"\n".join(line for line in lines if not line.startswith(b"#"))


def times_told(log: Path) -> set[str]:
    """Times of day (hhmmss) of the log's NMEA sentences."""
    return {match["time"].decode() for match in TIMED.finditer(content(log))}


def last_reports(log: Path) -> dict[str, Report]:
    """The last TPV of each time with a position, by its time."""
    reports = {}
    for line in log.with_suffix(".log.chk").read_text(encoding="latin-1").splitlines():
        if line.startswith('{"class":"TPV"'):
            report = json.loads(line)
            if report.get("mode", 0) >= 2 and "time" in report and "lat" in report:
                reports[report["time"]] = report
    return reports


def time_of_day(report: Report) -> str:
    return str(report["time"][11:19].replace(":", ""))


def millisecond(report: Report) -> int:
    return round(dt.datetime.fromisoformat(report["time"]).timestamp() * 1000.0)


def differences(report: Report, fix: GpsFix | None) -> Iterator[str]:
    """Names of what differs; a quantity that GPSD gives and the fix lacks differs."""
    if fix is None:
        yield "missing"
        return
    for name, ours, bound in (
        ("lat", fix.lat_deg, 1e-6),
        ("lon", fix.lon_deg, 1e-6),
        ("altMSL", fix.alt_m, 0.1),
        ("speed", fix.speed_mps, 0.05),
    ):
        if name in report and (ours is None or abs(ours - report[name]) > bound):
            yield name
    if "track" in report:
        course_deg = fix.course_deg
        if course_deg is None or abs((course_deg - report["track"] + 180.0) % 360.0 - 180.0) > 0.15:
            yield "track"


def compare(log: Path) -> Outcome:
    _, messages = replay(log)
    by_millisecond = {round(fix.t_ns / MILLISECOND_NS): fix for fix in fixes(messages) if fix.valid}
    times = times_told(log)
    reports = [each for each in last_reports(log).values() if time_of_day(each) in times]
    found = [list(differences(each, by_millisecond.get(millisecond(each)))) for each in reports]
    return Outcome(len(reports), found)


@pytest.fixture(scope="module")
def outcomes() -> dict[str, Outcome]:
    return {}


@pytest.fixture
def compared(recorded: Callable[[str], Path], outcomes: dict[str, Outcome]) -> dict[str, Outcome]:
    """Every log of the folder, compared once."""
    if not outcomes:
        logs = sorted(recorded("gpsd-conformance").glob("*.log"))
        outcomes.update({log.stem: compare(log) for log in logs})
    return outcomes


def test_at_least_99_percent_of_all_reports_agree(compared: dict[str, Outcome]) -> None:
    """What gpsd computes itself, as speed from positions, is counted too."""
    total = sum(outcome.reports for outcome in compared.values())
    different = sum(sum(map(bool, outcome.differences)) for outcome in compared.values())
    assert total > 1600
    assert 1.0 - different / total >= 0.99


def test_every_difference_is_explained(compared: dict[str, Outcome]) -> None:
    """Each row of the table: log, reports that differ, in what, why."""
    rows = [
        [cell.strip() for cell in line.strip("| \n").split("|")]
        for line in DIFFERENCES.read_text(encoding="utf-8").splitlines()
        if line.startswith("| `")
    ]
    explained = {name.strip("`"): (int(times), what) for name, times, what, _ in rows}
    found = {}
    for name, outcome in compared.items():
        kinds = Counter(kind for kinds in outcome.differences for kind in kinds)
        if kinds:
            found[name] = (sum(map(bool, outcome.differences)), ", ".join(sorted(kinds)))
    assert found == explained
    assert all(len(reason) > 20 for *_, reason in rows)


def test_every_wrong_checksum_is_counted(recorded: Callable[[str], Path]) -> None:
    """Recounted here sentence by sentence, binary logs left out."""
    counted, wrong = {}, {}
    for log in recorded("gpsd-conformance").glob("*.log"):
        if log.stem == "ublox-neo-m8l":  # its binary messages hold what looks like sentences
            continue
        core, _ = replay(log)
        counted[log.stem] = core.faults.get("checksum", 0)
        wrong[log.stem] = sum(
            reduce(xor, body, 0) != int(digits, 16)
            for body, digits in CHECKED.findall(content(log))
        )
    assert counted == wrong
    assert sum(counted.values()) == 103
