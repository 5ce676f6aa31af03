"""Recorded drives with their known faults."""

import datetime as dt
from collections import Counter
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from unit.gps_ingest.receiver import fixes, flush, hear, replay, rmc
from wayline.drive import Drive, DriveInfo, NmeaSource
from wayline.nmea_log import read_sentences
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.recorded import recordings

SHUTTLE = Path(__file__).parents[3] / "deploy" / "demo" / "avl-shuttle" / "gps.nmea"


def test_munich_keeps_every_fix_though_its_clock_goes_back(
    recorded: Callable[[str], Path],
) -> None:
    """1847 fixes and 20 epochs without; at 12:43:42 two seconds come twice."""
    core, messages = replay(recorded("nmea") / "munich.nmea")
    out = fixes(messages)
    assert sum(fix.valid for fix in out) == 1847
    assert sum(not fix.valid for fix in out) == 20
    assert core.faults == {"clock": 2}
    steps_ns = Counter(second.t_ns - first.t_ns for first, second in pairwise(out))
    assert min(steps_ns) > 0
    assert steps_ns[10**9] == len(out) - 1 - 3
    assert max(fix.speed_mps for fix in out if fix.speed_mps) == pytest.approx(17.3, abs=0.1)
    assert sum(fix.valid and fix.pdop is not None and fix.pdop > 8.0 for fix in out) > 0


def test_regensburg_survives_torn_lines_and_holes(recorded: Callable[[str], Path]) -> None:
    core, messages = replay(recorded("nmea") / "regensburg-geko.nmea")
    valid = [fix for fix in fixes(messages) if fix.valid]
    assert len(valid) == 774
    assert core.bad_input == 0
    assert min(fix.alt_m for fix in valid if fix.alt_m) == 295.0
    assert max(fix.alt_m for fix in valid if fix.alt_m) == 427.7


def test_the_shuttle_lap_is_193_fixes_and_19_repeats() -> None:
    """papers/000, Appendix C: 212 rows; the log has no date and is refused without one."""
    core = GpsIngestCore(date=dt.date(2011, 4, 1))
    texts = [sentence.text for sentence in read_sentences(SHUTTLE)]
    out = fixes(hear(core, texts) + flush(core))
    assert len(out) == 212
    assert sum(fix.valid for fix in out) == 193
    assert sum(fix.repeat for fix in out) == 19
    assert core.bad_input == 0
    assert out[-1].t_ns - out[0].t_ns == 219 * 10**9


def test_what_waited_after_a_pause_was_received_as_it_came(tmp_path: Path) -> None:
    """By a logger whose clock is a day behind: no fix becomes a late one by waiting."""
    seconds = [hour * 3600 + second for hour in (0, 2) for second in range(15)]
    noon_s = 764_424_000
    lines = [
        f"{noon_s - 86_400 + each}.200 {rmc(f'{12 + each // 3600:02d}00{each % 60:02d}')}\n"
        for each in seconds
    ]
    (tmp_path / "gps.nmea").write_text("".join(lines))
    drive = Drive(
        drive=DriveInfo(vehicle_id="car"), nmea=(NmeaSource(path=str(tmp_path / "gps.nmea")),)
    )
    (recording,) = recordings(drive, "drive.toml")
    heard = [
        (received_ns / 1e9 - noon_s + 86_400, message.t_ns)
        for received_ns, message in recording.messages
    ]
    assert [t_ns // 10**9 - noon_s for _, t_ns in heard] == seconds
    late_s = [received_s - seconds[at] for at, (received_s, _) in enumerate(heard)]
    assert min(late_s) > 0.0
    assert max(late_s) < 2.5
    assert recording.bad_input() == 0
