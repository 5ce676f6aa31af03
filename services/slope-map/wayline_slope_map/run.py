"""Pure: turns a finished track into runs over roads, smoothed sensor by sensor."""

import math
from collections.abc import Mapping

import numpy as np

from wayline.line import Floats
from wayline.tuning import Tuning
from wayline_slope_map.altitudes import Measured, barometer_altitudes, gps_altitudes
from wayline_slope_map.records import FinishedRun, RunBin, Sensor
from wayline_slope_map.roads import Road
from wayline_slope_map.slopes import NO_SLOPES, run_slopes
from wayline_slope_map.smoothing import Sensed, Smoothed, smooth
from wayline_slope_map.stretches import cut
from wayline_slope_map.track import Track

NONE = np.empty(0)
NOTHING = Measured(NONE, NONE, NONE, NONE, np.empty(0, dtype=np.intp))
STEEPEST_PCT = 50.0
"""No road is steeper; keeps a bad run out and the sums inside 64 bits."""


def finished_runs(
    track: Track, vehicle_id: str, roads: Mapping[str, Road], tuning: Tuning
) -> list[FinishedRun]:
    """The runs of a track over known and new roads, in order of time."""
    if len(track.places) < 2:
        return []
    stretches = cut(track.places, roads, tuning.map_bin_m)
    passed = [stretch.bins() for stretch in stretches]
    if not any(indices for indices, _ in passed):
        return []
    sizes = [len(indices) for indices, _ in passed]
    travelled_m = np.concatenate([distances_m for _, distances_m in passed])
    sensors = _smoothed_by_sensor(track, travelled_m, tuning)
    ends = np.cumsum(sizes).tolist()
    runs = []
    for stretch, (indices, _), end in zip(stretches, passed, ends, strict=True):
        bins = [
            run_bin
            for sensor, smoothed in sensors.items()
            for run_bin in _bins(sensor, smoothed, indices, end - len(indices), tuning)
        ]
        if bins:
            runs.append(
                FinishedRun(
                    vehicle_id=vehicle_id,
                    road=stretch.road,
                    direction=1 if stretch.direction > 0 else -1,
                    start_ns=stretch.start_ns,
                    end_ns=stretch.end_ns,
                    bins=tuple(bins),
                )
            )
    return runs


def _smoothed_by_sensor(
    track: Track, travelled_m: Floats, tuning: Tuning
) -> dict[Sensor, Smoothed]:
    """The run by all sensors that are to be used, and by each alone (papers/004 eq. 5.16)."""
    used = tuning.vertical_sensors
    gps = gps_altitudes(track, tuning) if "gps" in used else NOTHING
    barometer = barometer_altitudes(track, tuning) if "barometer" in used else NOTHING
    times_s = track.seconds_at(travelled_m)
    slopes = run_slopes(track, tuning)
    choices: dict[Sensor, Sensed] = {
        "fused": Sensed(gps, barometer, slopes["both"]),
        "gps": Sensed(gps, NOTHING, NO_SLOPES),
        "barometer": Sensed(NOTHING, barometer, NO_SLOPES),
        "torque": Sensed(NOTHING, NOTHING, slopes["torque"]),
        "vehicle": Sensed(NOTHING, NOTHING, slopes["vehicle"]),
    }
    sensors = {}
    for sensor, sensed in choices.items():
        smoothed = smooth(sensed, times_s, travelled_m, tuning)
        if smoothed is not None:
            sensors[sensor] = smoothed
    return sensors


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
