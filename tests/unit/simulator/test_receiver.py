import re
from pathlib import Path
from typing import Any

import numpy as np
import pynmea2
import pytest

from unit.simulator.gps_journeys import START_S, drive
from wayline.drive import Drive, DriveInfo, NmeaSource
from wayline.inputs import Flush, Sentence
from wayline.messages import GpsFix, GpsSky, Message
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.recorded import recordings
from wayline_simulator.course import Surroundings
from wayline_simulator.gps import Fixes, GpsModel, measure_fixes
from wayline_simulator.gps_events import GpsEvents, Outage
from wayline_simulator.journey import Journey
from wayline_simulator.nmea_text import course, place
from wayline_simulator.receiver import nmea_lines
from wayline_simulator.stream import TimedLine

ALL = ("RMC", "GGA", "GSA", "GSV", "GST", "VTG", "ZDA")
METRES_PER_DEG = 111_320.0


def received(
    journey: Journey, events: GpsEvents | None = None, **fields: Any
) -> tuple[Fixes, list[TimedLine]]:
    model = GpsModel(**fields)
    random = np.random.default_rng(5)
    fixes = measure_fixes(journey, model, events or GpsEvents(), START_S, random)
    return fixes, list(nmea_lines(fixes, model))


def heard(lines: list[TimedLine]) -> tuple[GpsIngestCore, list[Message]]:
    """What gps-ingest makes of sentences."""
    core = GpsIngestCore()
    messages = [
        message
        for line in lines
        for message in core.handle(
            Sentence(round(line.arrival_s * 1e9), line.text.decode("ascii")), "test"
        )
    ]
    return core, messages + core.handle(Flush(0), "test")


def decoded(lines: list[TimedLine]) -> list[GpsFix]:
    core, messages = heard(lines)
    assert core.bad_input == 0
    return [message for message in messages if isinstance(message, GpsFix)]


@pytest.mark.parametrize("systems", [("gps",), ("gps", "glonass", "galileo")])
@pytest.mark.parametrize("sentences", [ALL, ("GGA", "RMC"), ("ZDA", "GGA", "VTG", "GSA")])
def test_gps_ingest_reads_what_the_receiver_measured(
    systems: tuple[str, ...], sentences: tuple[str, ...]
) -> None:
    """Every number comes back within its rounding, whatever the sentences and their order."""
    fixes, lines = received(drive(20.0, 120.0), systems=systems, sentences=sentences)
    got = decoded(lines)
    assert len(got) == len(fixes.valid)
    for index, fix in enumerate(got):
        assert fix.t_ns == pytest.approx(fixes.timestamps_s[index] * 1e9, abs=1e3)
        assert fix.valid
        # 0.00001 minutes are 1.9 cm
        assert fix.lat_deg == pytest.approx(fixes.lats_deg[index], abs=0.51e-5 / 60.0)
        assert fix.lon_deg == pytest.approx(fixes.lons_deg[index], abs=0.51e-5 / 60.0)
        assert fix.alt_m == pytest.approx(fixes.alts_m[index], abs=0.051)
        assert fix.speed_mps == pytest.approx(fixes.speeds_mps[index], abs=0.0026)
        assert fix.course_deg == pytest.approx(fixes.courses_deg[index], abs=0.0051)
        assert fix.hdop == pytest.approx(fixes.hdop[index], abs=0.0051)


def test_gps_ingest_reads_the_sky() -> None:
    """Satellites, dilutions, stds and what is in view are those of the fix."""
    fixes, lines = received(drive(20.0, 30.0), sentences=ALL)
    _, messages = heard(lines)
    fix = next(message for message in messages if isinstance(message, GpsFix))
    sky = next(message for message in messages if isinstance(message, GpsSky))
    view = fixes.view
    assert fix.satellites == view.used[0].sum()
    assert fix.mode == 3
    assert fix.pdop == pytest.approx(fixes.pdop[0], abs=0.0051)
    assert fix.vdop == pytest.approx(fixes.vdop[0], abs=0.0051)
    assert fix.h_std_m == pytest.approx(fixes.h_std_m[0], abs=0.051)
    assert fix.v_std_m == pytest.approx(fixes.v_std_m[0], abs=0.051)
    assert sum(satellite.used for satellite in sky.satellites) == fix.satellites
    assert len(sky.satellites) == np.sum(view.elevations_deg[0] >= 0.0)
    assert {satellite.system for satellite in sky.satellites} == {"gps", "glonass"}


def test_a_blind_receiver_sends_empty_fields() -> None:
    """V and quality 0 with the time alone; gps-ingest takes every one as invalid."""
    events = GpsEvents(outages=(Outage(start_s=10.0, length_s=5.0),))
    _, lines = received(drive(20.0, 30.0), events, sentences=ALL, reacquire_s=0.0)
    assert [fix.valid for fix in decoded(lines)] == [True] * 10 + [False] * 5 + [True] * 16
    blind = [line.text for line in lines if b"070012.00" in line.text]
    assert blind[0].startswith(b"$GNRMC,070012.00,V,,,,,,,010126,,,N*")
    assert blind[1].startswith(b"$GNGGA,070012.00,,,,,0,00,99.99,,,,,,*")


@pytest.mark.parametrize("rate_hz", [2.0, 10.0])
def test_fast_receivers_are_read_too(rate_hz: float) -> None:
    """Every epoch comes back once, at its own time."""
    fixes, lines = received(drive(20.0, 20.0), rate_hz=rate_hz, baud_bps=115_200.0)
    times_s = [fix.t_ns / 1e9 for fix in decoded(lines)]
    assert times_s == pytest.approx(fixes.timestamps_s, abs=1e-6)


def test_sentences_come_as_slowly_as_the_line_is() -> None:
    """At 9600 baud 80 bytes take 83 ms, the first comes at the fix's arrival, none overtakes."""
    fixes, lines = received(drive(20.0, 20.0), baud_bps=9600.0, sentences=("RMC", "GGA"))
    assert lines[0].arrival_s == fixes.arrivals_s[0]
    after_s = lines[1].arrival_s - lines[0].arrival_s
    assert after_s == pytest.approx((len(lines[0].text) + 2) * 10 / 9600.0)
    _, crowded = received(drive(20.0, 20.0), baud_bps=9600.0, rate_hz=10.0, sentences=ALL)
    assert np.all(np.diff([line.arrival_s for line in crowded]) > 0.0)


def test_repeated_fixes_are_seen_as_such() -> None:
    """gps-ingest flags as many repeats as the receiver made."""
    fixes, lines = received(drive(20.0, 300.0), repeated_share=0.1)
    assert sum(fix.repeat for fix in decoded(lines)) == fixes.repeated.sum() > 10


def test_another_reader_accepts_every_sentence() -> None:
    """pynmea2 checks frame, checksum and the names of fields."""
    _, lines = received(drive(8.0, 30.0, Surroundings.CANYON), sentences=ALL)
    for line in lines:
        pynmea2.parse(line.text.decode("ascii"), check=True)
        assert len(line.text) <= 82


@pytest.mark.parametrize(
    ("lat_deg", "lon_deg", "text"),
    [
        (48.1173, 11.516667, "4807.03800,N,01131.00002,E"),
        (-0.5, -179.25, "0030.00000,S,17915.00000,W"),
        (9.99999999, 0.0, "1000.00000,N,00000.00000,E"),
    ],
)
def test_angles_are_written_as_degrees_and_minutes(
    lat_deg: float, lon_deg: float, text: str
) -> None:
    """Fields keep their width, and rounding never gives 60 minutes."""
    assert place(lat_deg, lon_deg, 5) == text


def test_a_course_of_nearly_a_full_turn_is_north() -> None:
    """359.999 is 0.00, not 360.00; unknown is blank."""
    assert course(359.999) == "0.00"
    assert course(float("nan")) == ""


def test_statistics_survive_the_whole_chain(tmp_path: Path) -> None:
    """Through file and gps-ingest: the error's std and its autocorrelation are the model's.

    10 h hold 360 correlation times of 100 s: std within 3 / sqrt(2 x 180), correlation within
    3 / sqrt(180) (a Gauss-Markov process has half as many independent values).
    """
    journey = drive(0.0, 36_000.0)
    fixes, lines = received(journey, position_wander_time_s=100.0, sentences=("RMC", "GGA"))
    path = tmp_path / "gps.nmea"
    path.write_bytes(b"".join(b"%.3f %s\r\n" % (line.arrival_s, line.text) for line in lines))
    drive_file = Drive(drive=DriveInfo(vehicle_id="car"), nmea=(NmeaSource(path=str(path)),))
    recording = recordings(drive_file, "drive.toml")[0]
    got = [message for _, message in recording.messages if isinstance(message, GpsFix)]
    assert len(got) == 36_001
    truth = journey.at(fixes.described_s)
    north_m = np.array([fix.lat_deg or 0.0 for fix in got]) - truth.lats_deg
    one = north_m * METRES_PER_DEG / fixes.hdop
    assert one.std() == pytest.approx(GpsModel().position_wander_std_m, rel=0.16)
    for lag_s, kept in ((0, 1.0), (50, np.exp(-0.5)), (100, np.exp(-1.0)), (300, np.exp(-3.0))):
        correlation = np.mean(one[: len(one) - lag_s] * one[lag_s:]) / np.mean(one * one)
        assert correlation == pytest.approx(kept, abs=0.22)


def test_munich_and_the_simulated_street_look_alike(recorded: Any) -> None:
    """Satellites in use and the spread of HDOP of a GPS-only receiver among houses."""
    text = (recorded("nmea") / "munich.nmea").read_text("ascii", "replace")
    real = [
        (int(used), float(hdop))
        for used, hdop in re.findall(r"GPGGA,[^*]*,1,(\d\d),([\d.]+),-?\d", text)
    ]
    used, hdop = np.array(real).T
    fixes, _ = received(
        drive(8.0, 3600.0, Surroundings.STREET), systems=("gps",), sentences=("GGA",)
    )
    sim_used = fixes.view.used[fixes.rows].sum(axis=1)[fixes.valid]
    assert np.median(sim_used) == pytest.approx(np.median(used), abs=1.0)
    assert np.median(fixes.hdop[fixes.valid]) == pytest.approx(np.median(hdop), rel=0.5)
