"""Pure: turns a finished track into runs over roads, smoothed sensor by sensor."""

import math
from collections.abc import Collection, Mapping
from typing import get_args

import numpy as np

from wayline.line import Floats
from wayline.tuning import Tuning
from wayline_slope_map.accounting import told
from wayline_slope_map.altitude_lag import lag_s
from wayline_slope_map.altitudes import Measured, barometer_altitudes, gps_altitudes
from wayline_slope_map.left_out import NO_HEIGHT, NO_ROAD, LeftOut
from wayline_slope_map.records import DrivenRun, FinishedRun, RunBin, Sensor
from wayline_slope_map.roads import Road
from wayline_slope_map.slopes import NO_SLOPES, run_slopes
from wayline_slope_map.smoothing import PASSES, Sensed, Smoothed, smooth
from wayline_slope_map.stretches import Stretch, cut
from wayline_slope_map.track import Track
from wayline_slope_map.untaught import doubt, untaught, unused, walking
from wayline_slope_map.walking_pace import is_driven

NONE = np.empty(0)
NOTHING = Measured(NONE, NONE, NONE, NONE, np.empty(0, dtype=np.intp))
PASSES_ALONE = 2
"""Over a run by one sensor, which is learned to be compared with the others."""
REFERENCE_STEP_M = 20.0
"""Between the altitudes by the other sensors that a receiver's are compared with."""
SENSORS: tuple[Sensor, ...] = get_args(Sensor)


def driven_run(
    track: Track, vehicle_id: str, roads: Mapping[str, Road], tuning: Tuning
) -> DrivenRun | str:
    """A finished track cut into stretches of known and new roads, or why it teaches nothing."""
    if len(track.places) < 2:
        return NO_ROAD
    if not track.tells_heights:
        return NO_HEIGHT
    stretches = tuple(cut(track.places, roads, tuning.map_bin_m))
    if not any(indices for indices, _ in (stretch.bins() for stretch in stretches)):
        return NO_ROAD
    return DrivenRun(vehicle_id=vehicle_id, track=track, stretches=stretches, tuning=tuning)


def smoothed_runs(driven: DrivenRun) -> list[FinishedRun]:
    """What a run says of each of its stretches, in order of time."""
    return [each for each in outcome(driven) if isinstance(each, FinishedRun)]


def outcome(driven: DrivenRun) -> list[FinishedRun | LeftOut]:
    """What a run says of each of its stretches, in order of time, and what of it is left out."""
    track, tuning = driven.track, driven.tuning
    passed = [stretch.bins() for stretch in driven.stretches]
    travelled_m = np.concatenate([distances_m for _, distances_m in passed])
    smoothed = smoothed_by_sensor(track, travelled_m, tuning)
    sensors = _where_taught(smoothed, track, travelled_m)
    ends = np.cumsum([len(indices) for indices, _ in passed]).tolist()
    runs = [
        _finished(driven, stretch, bins)
        for stretch, (indices, _), end in zip(driven.stretches, passed, ends, strict=True)
        if (bins := _of_stretch(sensors, indices, end - len(indices), tuning))
    ]
    spans = [
        *walking(track),
        *unused(track, smoothed, tuning),
        *untaught(track, travelled_m, sensors.get("fused"), tuning),
    ]
    return [*runs, *told(driven.vehicle_id, track, spans)]


def _finished(driven: DrivenRun, stretch: Stretch, bins: list[RunBin]) -> FinishedRun:
    return FinishedRun(
        vehicle_id=driven.vehicle_id,
        road=stretch.road,
        direction=1 if stretch.direction > 0 else -1,
        start_ns=stretch.start_ns,
        end_ns=stretch.end_ns,
        bins=tuple(bins),
    )


def _of_stretch(
    sensors: Mapping[Sensor, Smoothed], indices: list[int], first: int, tuning: Tuning
) -> list[RunBin]:
    return [
        run_bin
        for sensor, smoothed in sensors.items()
        for run_bin in _bins(sensor, smoothed, indices, first, tuning)
    ]


def _where_taught(
    sensors: dict[Sensor, Smoothed], track: Track, travelled_m: Floats
) -> dict[Sensor, Smoothed]:
    """Nothing is known where the run teaches no road."""
    taught = is_driven(track, travelled_m) & (travelled_m <= track.doubted_from_m)
    return {
        sensor: smoothed._replace(
            alt_m=np.where(taught, smoothed.alt_m, np.nan),
            alt_std_m=np.where(taught, smoothed.alt_std_m, np.nan),
            grade_pct=np.where(taught, smoothed.grade_pct, np.nan),
            grade_std_pct=np.where(taught, smoothed.grade_std_pct, np.nan),
        )
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
            float(values[first + offset])
            for values in (
                smoothed.alt_m,
                smoothed.alt_std_m,
                smoothed.grade_pct,
                smoothed.grade_std_pct,
            )
        )
        if math.isfinite(alt_m) and doubt(grade_pct, grade_std_pct, tuning) is None:
            bins.append(RunBin(bin_index, sensor, grade_pct, grade_std_pct, alt_m, alt_std_m))
    return bins
