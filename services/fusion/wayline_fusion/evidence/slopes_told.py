"""Pure: what each sensor alone says of the slope, for people to compare.

papers/004 looks at GPS altitude, barometer and torque one at a time; fusion weighs them together
and tells one slope. Nothing from here goes back into it.
"""

import math
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from statistics import fmean, linear_regression, stdev
from typing import TypeVar

from wayline.messages import SensorSlope
from wayline.vertical.propulsion import Push
from wayline_fusion.filter.vertical import Progress, TorqueErrors
from wayline_fusion.intake.events import Event, GpsAltitude, Pressure, ReportedSlope

OVER_M = 200.0
"""Of the way just driven: over a shorter one altimeters tell noise."""
SPAN_MIN_M = 100.0
LATEST_M = 50.0
"""Who has told nothing for longer, as torque while brakes hold, speaks of another stretch."""
APART_M = 4.0
"""Altitudes closer together tell little more than one of them."""
READINGS_MIN = 5
READINGS_MAX = 400
"""A vehicle that creeps tells no more of a slope than one that drives."""

Told = TypeVar("Told")
Named = tuple[str, str | None]
"""Sensor, and the receiver where it is one of several."""
Readings = deque[tuple[float, float]]
"""How far the vehicle had come (m), and an altitude (m) or a slope as a tangent."""


class SlopesTold:
    """Remembers what sensors told of the last 200 m driven forwards."""

    def __init__(self) -> None:
        self._at_m = 0.0
        self._altitudes: dict[Named, Readings] = {}
        self._reported: Readings = deque(maxlen=READINGS_MAX)
        self._pushes: deque[tuple[float, Push]] = deque(maxlen=READINGS_MAX)

    def take(self, event: Event, progress: Progress) -> None:
        """Take an event when the vehicle has come so far; most kinds tell nothing of a slope."""
        self._at_m = at_m = progress.distance_m
        if progress.speed_mps < 0.0:
            self._forget()
        elif isinstance(event, GpsAltitude):
            self._climb(("gps_altitude", event.source), at_m, event.alt_m)
        elif isinstance(event, Pressure):
            self._climb(("barometer", None), at_m, event.alt_m)
        elif isinstance(event, Push):
            _keep(self._pushes, at_m, event)
        elif isinstance(event, ReportedSlope):
            _keep(self._reported, at_m, event.slope)

    def told(self, torque: TorqueErrors | None) -> Iterator[SensorSlope]:
        """What each says now; torque with the mass and the bias that fusion has found."""
        for (sensor, source), readings in self._altitudes.items():
            yield from _regressed(sensor, source, self._recent(readings))
        if torque is not None:
            slopes = [
                (at_m, push.share / torque.mass - push.level - torque.bias)
                for at_m, push in self._pushes
                if not push.is_braked
            ]
            yield from _mean("torque", self._recent(slopes))
        yield from _mean("vehicle_slope", self._recent(self._reported))

    def _recent(self, readings: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
        """Those of the last 200 m; none where they do not span enough of it."""
        recent = [each for each in readings if self._at_m - each[0] <= OVER_M]
        if len(recent) < READINGS_MIN or recent[-1][0] - recent[0][0] < SPAN_MIN_M:
            return []
        return recent if self._at_m - recent[-1][0] <= LATEST_M else []

    def _climb(self, named: Named, at_m: float, alt_m: float) -> None:
        readings = self._altitudes.setdefault(named, deque())
        if not readings or at_m - readings[-1][0] >= APART_M:
            _keep(readings, at_m, alt_m)

    def _forget(self) -> None:
        """In reverse what was uphill is downhill."""
        self._altitudes.clear()
        self._reported.clear()
        self._pushes.clear()


def _keep(kept: deque[tuple[float, Told]], at_m: float, told: Told) -> None:
    kept.append((at_m, told))
    while at_m - kept[0][0] > OVER_M:
        kept.popleft()


def _regressed(
    sensor: str, source: str | None, readings: Sequence[tuple[float, float]]
) -> Iterator[SensorSlope]:
    """The slope of a line through altitudes."""
    if not readings:
        return
    places_m, alts_m = zip(*readings, strict=True)
    slope, alt_m = linear_regression(places_m, alts_m)
    middle_m = fmean(places_m)
    off_m2 = sum((alt - alt_m - slope * place) ** 2 for place, alt in readings)
    spread_m2 = sum((place - middle_m) ** 2 for place in places_m)
    std = math.sqrt(off_m2 / (len(readings) - 2) / spread_m2)
    yield SensorSlope(
        sensor=sensor, source=source, slope_pct=100.0 * slope, slope_std_pct=100.0 * std
    )


def _mean(sensor: str, readings: Sequence[tuple[float, float]]) -> Iterator[SensorSlope]:
    if not readings:
        return
    slopes = [slope for _, slope in readings]
    std = stdev(slopes) / math.sqrt(len(slopes))
    yield SensorSlope(sensor=sensor, slope_pct=100.0 * fmean(slopes), slope_std_pct=100.0 * std)
