"""A simulated receiver's raw measurements against geometry worked out another way."""

from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np
import pytest

from unit.simulator.gps_journeys import START_S, drive
from wayline.satellites.earth import EARTH_RATE_RADPS, SPEED_OF_LIGHT_MPS
from wayline_simulator.constellation import TO_EARTH_FIXED
from wayline_simulator.course import Surroundings
from wayline_simulator.drive_folder import simulate
from wayline_simulator.gps import GpsModel, measure_fixes
from wayline_simulator.gps_events import GpsEvents, Outage
from wayline_simulator.journey import Floats, Journey
from wayline_simulator.raw_epochs import Measured, measure_raw
from wayline_simulator.raw_errors import raw_errors
from wayline_simulator.raw_model import RawModel
from wayline_simulator.receiver import GEOID_SEP_M
from wayline_simulator.road_model import RoadModel
from wayline_simulator.scenario import Scenario

EXACT_GPS = GpsModel(systems=("gps",), position_wander_std_m=0.0, velocity_std_mps=0.0)
EXACT = RawModel(
    code_std_m=0.0,
    clock_drift_walk_mps=0.0,
    clock_walk_m=0.0,
    echo_doppler_std_mps=0.0,
    mixed_street_m=0.0,
    mixed_canyon_m=0.0,
)
LIGHT_MS_M = SPEED_OF_LIGHT_MPS * 1e-3


class Seen(NamedTuple):
    told: Measured
    journey: Journey

    def of(self, prn: int) -> "Seen":
        """One satellite alone."""
        mine = self.told.prns == prn
        return self._replace(told=Measured(*(column[mine] for column in self.told)))

    def ranges_m(self) -> Floats:
        """Straight lines from the satellites to the truth, and the earth's turn by Sagnac's term.

        The term is IS-GPS-200's: the rate of the turn times twice an area, over the light's speed.
        """
        truth = self.journey.at(self.told.times_s - START_S)
        own_m = np.stack(
            TO_EARTH_FIXED.transform(truth.lons_deg, truth.lats_deg, truth.alts_m + GEOID_SEP_M), -1
        )
        places_m = self.told.places_m
        turned = places_m[:, 0] * own_m[:, 1] - places_m[:, 1] * own_m[:, 0]
        straight_m = np.linalg.norm(places_m - own_m, axis=1)
        return np.asarray(straight_m + EARTH_RATE_RADPS / SPEED_OF_LIGHT_MPS * turned)


def seen(
    journey: Journey, gps: GpsModel = EXACT_GPS, raw: RawModel = EXACT, *outages: Outage
) -> Seen:
    random = np.random.default_rng(5)
    fixes = measure_fixes(journey, gps, GpsEvents(outages=outages), START_S, random)
    errors = raw_errors(fixes, journey.at(fixes.timestamps_s - START_S), gps, raw, random)
    truth = journey.at(fixes.timestamps_s - START_S)
    parts = list(measure_raw(truth, fixes, gps, errors, raw.least_dbhz))
    columns = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Seen(Measured(*columns), journey)


def test_under_an_open_sky_pseudoranges_are_ranges_and_one_clock() -> None:
    open_sky = seen(drive(), raw=msgspec.structs.replace(EXACT, clock_resets=False))
    clocks_m = open_sky.told.pseudoranges_m - open_sky.ranges_m()
    seconds = open_sky.told.times_s - START_S
    fit = np.polynomial.Polynomial.fit(seconds, clocks_m, 1)
    assert len(seconds) > 4000
    assert np.abs(clocks_m - fit(seconds)).max() < 0.01
    assert abs(fit.convert().coef[1]) > 1.0


def test_dopplers_are_the_rates_of_the_pseudoranges() -> None:
    """By central differences over two seconds, at 15 m/s in every direction."""
    for heading_deg in (0.0, 130.0, 250.0):
        open_sky = seen(drive(heading_deg=heading_deg, duration_s=60.0, grade=0.05))
        for prn in set(open_sky.told.prns.tolist()):
            told = open_sky.of(prn).told
            if len(told.times_s) < 60 or np.abs(np.diff(told.pseudoranges_m)).max() > 5e4:
                continue
            rates_mps = (told.pseudoranges_m[2:] - told.pseudoranges_m[:-2]) / 2.0
            dopplers_mps = -told.dopplers_hz[1:-1] * SPEED_OF_LIGHT_MPS / told.carriers_hz[1:-1]
            assert dopplers_mps == pytest.approx(rates_mps, abs=0.03)


def test_motions_are_the_rates_of_the_places() -> None:
    told = seen(drive(duration_s=60.0)).of(4).told
    rates_mps = (told.places_m[2:] - told.places_m[:-2]) / 2.0
    assert told.motions_mps[1:-1] == pytest.approx(rates_mps, abs=0.01)


def test_a_clock_is_set_by_whole_milliseconds() -> None:
    raw = msgspec.structs.replace(EXACT, clock_drift_std_mps=2_000.0)
    told = seen(drive(duration_s=900.0), raw=raw)
    clocks_m = told.told.pseudoranges_m - told.ranges_m()
    steps_m = np.diff(clocks_m[np.unique(told.told.times_s, return_index=True)[1]])
    leaps = np.abs(steps_m) > 0.5 * LIGHT_MS_M
    assert np.abs(clocks_m).max() <= 0.5 * LIGHT_MS_M + 0.01
    assert 1 <= leaps.sum() < 30
    assert np.abs(np.abs(steps_m[leaps]) - LIGHT_MS_M).max() < 0.05 * LIGHT_MS_M


def test_what_is_out_of_sight_comes_late_and_weak() -> None:
    canyon = seen(drive(8.0, 900.0, Surroundings.CANYON), EXACT_GPS)
    clocks_m = canyon.told.pseudoranges_m - canyon.ranges_m()
    late_m = np.empty_like(clocks_m)
    for time_s in np.unique(canyon.told.times_s):
        now = canyon.told.times_s == time_s
        straight = now & canyon.told.in_sight
        late_m[now] = clocks_m[now] - (clocks_m[straight].mean() if straight.any() else np.nan)
    echoes_m = late_m[~canyon.told.in_sight & np.isfinite(late_m)]
    assert len(echoes_m) > 500
    assert echoes_m.min() > 0.0
    assert 15.0 < np.median(echoes_m) < 40.0
    strengths = canyon.told.strengths_dbhz
    assert strengths[canyon.told.in_sight].mean() > strengths[~canyon.told.in_sight].mean() + 5.0


def test_who_stands_keeps_an_echo() -> None:
    """At a light the same wall reflects for as long as it takes; the clock is left out."""
    raw = msgspec.structs.replace(EXACT, clock_drift_std_mps=0.0)
    standing = seen(drive(0.0, 120.0, Surroundings.CANYON), EXACT_GPS, raw)
    late_m = standing.told.pseudoranges_m - standing.ranges_m()
    for prn in set(standing.told.prns[~standing.told.in_sight].tolist()):
        mine = (standing.told.prns == prn) & ~standing.told.in_sight
        assert np.ptp(late_m[mine]) < 1.0


def test_nothing_is_measured_in_a_tunnel_or_an_outage() -> None:
    told = seen(
        drive(covered_m=(3000.0, 4500.0)), EXACT_GPS, EXACT, Outage(start_s=50, length_s=30)
    )
    seconds = np.unique(told.told.times_s - START_S)
    assert not np.any((seconds >= 50.0) & (seconds < 80.0))
    assert not np.any((seconds > 200.5) & (seconds < 299.5))
    assert {100.0, 350.0} <= set(seconds.tolist())


def test_each_further_system_has_a_clock_of_its_own() -> None:
    gps = msgspec.structs.replace(EXACT_GPS, systems=("gps", "glonass"))
    both = seen(drive(), gps)
    clocks_m = both.told.pseudoranges_m - both.ranges_m()
    first = both.told.times_s == both.told.times_s[0]
    apart_m = [clocks_m[first & (both.told.systems == system)] for system in (0, 1)]
    assert max(map(np.ptp, apart_m)) < 0.01
    assert abs(apart_m[0].mean() - apart_m[1].mean()) > 1.0
    glonass = both.told.systems == 1
    assert len(set(both.told.carriers_hz[glonass].tolist())) > 4
    assert both.told.prns[glonass].max() <= 24


def written(folder: Path, raw: RawModel | None, seed: int = 1) -> Path:
    road = RoadModel(kind="urban", length_m=1500.0)
    simulate(Scenario(preset="mems", road=road, raw=raw, seed=seed), folder)
    return folder


def test_the_same_seed_gives_the_same_bytes_and_leaves_the_fixes_alone(tmp_path: Path) -> None:
    with_raw, again = (written(tmp_path / name, RawModel()) for name in ("with", "again"))
    without = written(tmp_path / "without", None)
    other = written(tmp_path / "other", RawModel(), seed=2)
    table = (with_raw / "raw.csv").read_bytes()
    assert table == (again / "raw.csv").read_bytes() != (other / "raw.csv").read_bytes()
    assert (with_raw / "gps.nmea").read_bytes() == (without / "gps.nmea").read_bytes()
    assert not (without / "raw.csv").exists()
    assert "[[raw]]" not in (without / "drive.toml").read_text()
