"""Pure: what of a smoothed run teaches no road, and the sensors that were not used."""

from collections.abc import Iterator, Mapping

import numpy as np

from wayline.line import Floats
from wayline.tuning import Tuning
from wayline.vertical.trust import NO_SUCH_MASS
from wayline_slope_map.accounting import whole
from wayline_slope_map.left_out import COARSE, TOO_STEEP, UNSURE, WALKED, Altimeter, Span, Spans
from wayline_slope_map.records import Sensor
from wayline_slope_map.smoothing import Smoothed
from wayline_slope_map.track import Track
from wayline_slope_map.walking_pace import walked

STEEPEST_PCT = 50.0
"""No road is steeper; keeps a bad run out and the sums inside 64 bits."""


def doubt(grade_pct: float, grade_std_pct: float, tuning: Tuning) -> str | None:
    """Why a grade is none to learn; None for a good one, and for one that is not known (NaN)."""
    if grade_std_pct > tuning.map_grade_std_max_pct:
        return UNSURE
    return TOO_STEEP if abs(grade_pct) > STEEPEST_PCT else None


def walking(track: Track) -> Iterator[Span]:
    """Where the run went too slowly, those that overlap as one."""
    last: Span | None = None
    for from_m, to_m in walked(track):
        bounds = np.clip((from_m, to_m), track.travelled_m[0], track.travelled_m[-1])
        span = _span(track, None, WALKED, bounds)
        if last is not None and span.from_m <= last.to_m:
            last = last._replace(end_ns=span.end_ns, to_m=span.to_m)
            continue
        if last is not None:
            yield last
        last = span
    if last is not None:
        yield last


def untaught(
    track: Track, travelled_m: Floats, fused: Smoothed | None, tuning: Tuning
) -> Iterator[Span]:
    """Where the grade by all sensors, at distances of shape (n,), is none to learn."""
    spans = Spans()
    order = np.argsort(travelled_m, kind="stable")
    times_ns = _times_ns(track, travelled_m)
    for k in order.tolist():
        reason = UNSURE if fused is None else _doubt_at(k, fused, tuning)
        spans.note("grade", reason, times_ns[k], float(travelled_m[k]), None)
    yield from spans.take()


def _doubt_at(k: int, fused: Smoothed, tuning: Tuning) -> str | None:
    return doubt(float(fused.grade_pct[k]), float(fused.grade_std_pct[k]), tuning)


def unused(track: Track, smoothed: Mapping[Sensor, Smoothed], tuning: Tuning) -> Iterator[Span]:
    """The sensors that told something over the run and were not used for all that."""
    is_asked = "barometer" in tuning.vertical_sensors and len(track.pressures) > 1
    if is_asked and "barometer" not in smoothed:
        yield from _all_of(track, "barometer", COARSE)
    fused = smoothed.get("fused")
    if fused is not None and not fused.is_such_vehicle:
        yield from _all_of(track, "torque", NO_SUCH_MASS)


def _all_of(track: Track, sensor: Altimeter, reason: str) -> Iterator[Span]:
    return (span._replace(sensor=sensor) for span in whole(track, reason))


def _span(track: Track, sensor: Altimeter | None, reason: str, bounds_m: Floats) -> Span:
    start_ns, end_ns = _times_ns(track, bounds_m)
    from_m, to_m = bounds_m.tolist()
    return Span(sensor, reason, start_ns, end_ns, from_m, to_m)


def _times_ns(track: Track, travelled_m: Floats) -> list[int]:
    times_ns = np.rint(1e9 * track.seconds_at(travelled_m)).astype(np.int64) + track.start_ns
    return [int(each) for each in times_ns]
