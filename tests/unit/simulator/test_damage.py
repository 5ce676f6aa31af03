from pathlib import Path

import numpy as np
import pytest

from unit.simulator.gps_journeys import START_S, drive
from wayline.inputs import Flush
from wayline.messages import GpsFix
from wayline.nmea_log import read_sentences
from wayline_gps_ingest.core import GpsIngestCore
from wayline_simulator.damage import Damage, Frame, damaged_frames, damaged_lines
from wayline_simulator.gps import GpsModel, measure_fixes
from wayline_simulator.gps_events import GpsEvents
from wayline_simulator.receiver import nmea_lines
from wayline_simulator.stream import TimedLine

LINES = [TimedLine(float(number), b"$GPXXX,%05d*00" % number) for number in range(4000)]
FRAMES: list[Frame] = [(float(number), 0x100, bytes(range(6))) for number in range(4000)]
SHARE = 0.1
COUNT = pytest.approx(400, abs=60)
"""A tenth of 4000, within three sigma."""


def harmed(damage: Damage) -> list[TimedLine]:
    return list(damaged_lines(LINES, damage, np.random.default_rng(1)))


def harmed_frames(damage: Damage) -> list[Frame]:
    return list(damaged_frames(FRAMES, damage, np.random.default_rng(1)))


def test_an_intact_link_changes_nothing() -> None:
    """Neither lines nor frames."""
    assert harmed(Damage()) == LINES
    assert harmed_frames(Damage()) == FRAMES


def test_flipped_sentences_differ_in_one_bit() -> None:
    """The share that was asked for, each by a single bit, no line's end among them."""
    after = harmed(Damage(sentences_flipped=SHARE))
    different = [
        int.from_bytes(new.text, "big") ^ int.from_bytes(old.text, "big")
        for new, old in zip(after, LINES, strict=True)
        if new != old
    ]
    assert len(different) == COUNT
    assert all(bits.bit_count() == 1 for bits in different)
    assert not any(b"\n" in line.text or b"\r" in line.text for line in after)


def test_torn_sentences_lack_their_end() -> None:
    """At least a byte stays, at least one is missing."""
    after = harmed(Damage(sentences_torn=SHARE))
    torn = [(new.text, old.text) for new, old in zip(after, LINES, strict=True) if new != old]
    assert len(torn) == COUNT
    assert {len(new) for new, _ in torn} == set(range(1, len(LINES[0].text)))
    assert all(old.startswith(new) and 0 < len(new) < len(old) for new, old in torn)


def test_glued_sentences_share_a_line() -> None:
    """Nothing of them is lost."""
    after = harmed(Damage(sentences_glued=SHARE))
    assert len(LINES) - len(after) == COUNT
    assert b"".join(line.text for line in after) == b"".join(line.text for line in LINES)


def test_repeated_sentences_come_twice() -> None:
    """One right after the other."""
    after = harmed(Damage(sentences_repeated=SHARE))
    assert len(after) - len(LINES) == COUNT
    assert sorted(set(after)) == LINES
    assert after == sorted(after)


def test_late_sentences_are_overtaken_and_the_log_stays_in_order() -> None:
    """They come `late_s` later, behind those that were sent meanwhile."""
    after = harmed(Damage(sentences_late=SHARE, late_s=2.5))
    assert sorted(line.text for line in after) == [line.text for line in LINES]
    arrivals_s = [line.arrival_s for line in after]
    assert arrivals_s == sorted(arrivals_s)
    late = [line for line in after if line.arrival_s % 1.0 == 0.5]
    assert len(late) == COUNT
    assert all(line.text == b"$GPXXX,%05d*00" % (line.arrival_s - 2.5) for line in late)


def test_noise_stands_in_lines_of_its_own() -> None:
    """And holds no line's end."""
    after = harmed(Damage(noise_between=SHARE))
    noise = [line.text for line in after if not line.text.startswith(b"$GPXXX")]
    assert len(noise) == COUNT
    assert [line for line in after if line.text.startswith(b"$GPXXX")] == LINES
    assert not any({0x0A, 0x0D} & set(text) for text in noise)


def test_frames_are_lost_shortened_lengthened_and_repeated() -> None:
    """By the shares that were asked for, data otherwise as it was."""
    data = bytes(range(6))
    assert 4000 - len(harmed_frames(Damage(frames_lost=SHARE))) == COUNT
    short = [frame[2] for frame in harmed_frames(Damage(frames_short=SHARE)) if len(frame[2]) < 6]
    assert len(short) == COUNT
    assert all(data.startswith(part) for part in short)
    assert {len(part) for part in short} == set(range(6))
    long = [frame[2] for frame in harmed_frames(Damage(frames_long=SHARE)) if len(frame[2]) == 8]
    assert len(long) == COUNT
    assert all(whole.startswith(data) for whole in long)
    assert len(harmed_frames(Damage(frames_repeated=SHARE))) - 4000 == COUNT


def test_the_same_seed_does_the_same_harm() -> None:
    """To the last byte."""
    damage = Damage(sentences_flipped=SHARE, noise_between=SHARE, sentences_late=SHARE)
    assert harmed(damage) == harmed(damage)


def test_gps_ingest_lives_with_a_bad_link(tmp_path: Path) -> None:
    """It counts the damage, and no fix that it lets through is wrong."""
    journey = drive(15.0, 600.0)
    model = GpsModel()
    random = np.random.default_rng(2)
    fixes = measure_fixes(journey, model, GpsEvents(), START_S, random)
    damage = Damage(
        sentences_flipped=0.02, sentences_torn=0.02, sentences_glued=0.02, noise_between=0.02
    )
    core = GpsIngestCore()
    got: list[GpsFix] = []
    path = tmp_path / "gps.nmea"
    lines = damaged_lines(nmea_lines(fixes, model), damage, random)
    path.write_bytes(b"".join(b"%.3f %s\r\n" % (line.arrival_s, line.text) for line in lines))
    for sentence in read_sentences(path):
        messages = core.handle(sentence, "test")
        got += [message for message in messages if isinstance(message, GpsFix)]
    got += [message for message in core.handle(Flush(0), "test") if isinstance(message, GpsFix)]
    assert core.bad_input > 100
    valid = [fix for fix in got if fix.valid]
    assert len(valid) > 550
    index = [round(fix.t_ns / 1e9 - START_S) for fix in valid]
    assert [fix.lat_deg for fix in valid] == pytest.approx(fixes.lats_deg[index], abs=1e-6)
