"""Pure: turns a finished track into runs over roads, smoothed sensor by sensor."""

import math
from collections.abc import Collection, Mapping
from typing import get_args

import numpy as np

from wayline.line import Floats
from wayline.tuning import Tuning
from wayline_slope_map.altitude_lag import lag_s
from wayline_slope_map.altitudes import Measured, barometer_altitudes, gps_altitudes
from wayline_slope_map.records import DrivenRun, FinishedRun, RunBin, Sensor
from wayline_slope_map.roads import Road
from wayline_slope_map.slopes import NO_SLOPES, run_slopes
from wayline_slope_map.smoothing import PASSES, Sensed, Smoothed, smooth
from wayline_slope_map.stretches import cut
from wayline_slope_map.track import Track
from wayline_slope_map.walking_pace import is_driven

NONE = np.empty(0)
NOTHING = Measured(NONE, NONE, NONE, NONE, np.empty(0, dtype=np.intp))
PASSES_ALONE = 2
"""Over a run by one sensor, which is learned to be compared with the others."""
REFERENCE_STEP_M = 20.0
"""Between the altitudes by the other sensors that a receiver's are compared with."""
SENSORS: tuple[Sensor, ...] = get_args(Sensor)
STEEPEST_PCT = 50.0
"""No road is steeper; keeps a bad run out and the sums inside 64 bits."""


def driven_run(
    track: Track, vehicle_id: str, roads: Mapping[str, Road], tuning: Tuning
) -> DrivenRun | None:
    """A finished track cut into stretches of known and new roads; None where it tells nothing."""
    if len(track.places) < 2 or not track.tells_heights:
        return None
    stretches = tuple(cut(track.places, roads, tuning.map_bin_m))
    if not any(indices for indices, _ in (stretch.bins() for stretch in stretches)):
        return None
    return DrivenRun(vehicle_id=vehicle_id, track=track, stretches=stretches, tuning=tuning)


def smoothed_runs(driven: DrivenRun) -> list[FinishedRun]:
    """What a run says of each of its stretches, in order of time."""
    track, tuning = driven.track, driven.tuning
    passed = [stretch.bins() for stretch in driven.stretches]
    sizes = [len(indices) for indices, _ in passed]
    travelled_m = np.concatenate([distances_m for _, distances_m in passed])
    sensors = _without_walked(smoothed_by_sensor(track, travelled_m, tuning), track, travelled_m)
    ends = np.cumsum(sizes).tolist()
    runs = []
    for stretch, (indices, _), end in zip(driven.stretches, passed, ends, strict=True):
        bins = [
            run_bin
            for sensor, smoothed in sensors.items()
            for run_bin in _bins(sensor, smoothed, indices, end - len(indices), tuning)
        ]
        if bins:
            runs.append(
                FinishedRun(
                    vehicle_id=driven.vehicle_id,
                    road=stretch.road,
                    direction=1 if stretch.direction > 0 else -1,
                    start_ns=stretch.start_ns,
                    end_ns=stretch.end_ns,
                    bins=tuple(bins),
                )
            )
    return runs


def _without_walked(
    sensors: dict[Sensor, Smoothed], track: Track, travelled_m: Floats
) -> dict[Sensor, Smoothed]:
    """Nothing is known where the run teaches no road."""
    walked = ~is_driven(track, travelled_m)
    return {
        sensor: Smoothed(*(np.where(walked, np.nan, each) for each in smoothed))
        for sensor, smoothed in sensors.items()
    }


def smoothed_by_sensor(
    track: Track, travelled_m: Floats, tuning: Tuning, wanted: Collection[Sensor] = SENSORS
) -> dict[Sensor, Smoothed]:
    """Altitude and grade at distances travelled, shape (n,), by all sensors and by each alone.

    `vertical_sensors` says which of them are used at all (papers/004 eq. 5.16); of those that are
    `wanted`, the ones that tell too little are left out.
    """
    used = tuning.vertical_sensors
    barometer = barometer_altitudes(track, tuning) if "barometer" in used else NOTHING
    slopes = run_slopes(track, tuning)
    beside = Sensed(NOTHING, barometer, slopes["both"])
    gps = _prompt(track, gps_altitudes(track, tuning), beside, tuning) if "gps" in used else NOTHING
    times_s = track.seconds_at(travelled_m)
    choices: dict[Sensor, Sensed] = {
        "fused": Sensed(gps, barometer, slopes["both"]),
        "gps": Sensed(gps, NOTHING, NO_SLOPES),
        "barometer": Sensed(NOTHING, barometer, NO_SLOPES),
        "torque": Sensed(NOTHING, NOTHING, slopes["torque"]),
        "vehicle": Sensed(NOTHING, NOTHING, slopes["vehicle"]),
    }
    sensors = {}
    for sensor in wanted:
        passes = PASSES if sensor == "fused" else PASSES_ALONE
        smoothed = smooth(choices[sensor], times_s, travelled_m, tuning, passes)
        if smoothed is not None:
            sensors[sensor] = smoothed
    return sensors


def _prompt(track: Track, gps: Measured, beside: Sensed, tuning: Tuning) -> Measured:
    """Altitudes of receivers at the instants that they are of, as the other sensors tell them."""
    travelled_m = np.arange(track.travelled_m[0], track.travelled_m[-1], REFERENCE_STEP_M)
    smoothed = smooth(beside, track.seconds_at(travelled_m), travelled_m, tuning, passes=1)
    if smoothed is None:
        return gps
    alt_m = smoothed.alt_m

    def heights(times_s: Floats) -> Floats:
        return np.interp(track.travelled_at(times_s), travelled_m, alt_m)

    times_s = gps.times_s.copy()
    for receiver in np.unique(gps.receiver):
        its = gps.receiver == receiver
        times_s[its] -= lag_s(gps.times_s[its], gps.alt_m[its], heights)
    return gps._replace(times_s=times_s, travelled_m=track.travelled_at(times_s))


def _bins(
    sensor: Sensor, smoothed: Smoothed, indices: list[int], first: int, tuning: Tuning
) -> list[RunBin]:
    """The bins of one stretch, whose values start at `first`, but for those that say too little."""
    bins = []
    for offset, bin_index in enumerate(indices):
        alt_m, alt_std_m, grade_pct, grade_std_pct = (
            float(values[first + offset]) for values in smoothed
        )
        certain = grade_std_pct <= tuning.map_grade_std_max_pct and abs(grade_pct) <= STEEPEST_PCT
        if certain and math.isfinite(alt_m):
            bins.append(RunBin(bin_index, sensor, grade_pct, grade_std_pct, alt_m, alt_std_m))
    return bins
