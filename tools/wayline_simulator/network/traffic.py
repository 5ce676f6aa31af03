"""Pure: how quick the streets of a simulated network are, by time of day, day and place.

Each stretch between two stops has a speed of its own, which no timetable knows; rush hours, the
day and congestion, which all buses there share, slow it down.
"""

import datetime as dt
import math

import numpy as np
from numpy.typing import NDArray

from wayline_simulator.network.model import NetworkModel, Part, randomness
from wayline_simulator.network.streets import Way, segments
from wayline_simulator.noise import gauss_markov

Floats = NDArray[np.float64]
Segment = tuple[str, str]
"""The stops at both ends."""

USUAL_MPS = 9.0
"""Between standstills; the timetable is made with it."""
OWN_STD, DAY_STD, RUN_STD = 0.2, 0.05, 0.08
"""Of the logarithm of the time that a stretch, a day and a driver take."""
CONGESTION_STD, CONGESTION_S = 0.25, 1_200.0
STEP_S = 60.0
DAY_S = 30 * 3600.0
RUSHES = ((8.0, 0.8, 0.4), (17.0, 1.2, 0.4))
"""Middle and width in hours, and what it adds to the time of a stretch."""
SATURDAY = 5


def is_weekday(day: dt.date) -> bool:
    """Whether rush hours are to be expected."""
    return day.weekday() < SATURDAY


def rush(time_s: float) -> float:
    """What rush hours add to the time of a stretch on a weekday, as a share."""
    hour = time_s / 3600.0
    return sum(most * math.exp(-0.5 * ((hour - at) / width) ** 2) for at, width, most in RUSHES)


class DayTraffic:
    """The streets on one day; times in seconds after its midnight."""

    def __init__(
        self, model: NetworkModel, ways: tuple[Way, ...], day: dt.date, number: int
    ) -> None:
        known = sorted({segment for way in ways for segment in segments(way)})
        own = randomness(model, Part.STREET_SPEEDS).normal(0.0, OWN_STD, len(known))
        random = randomness(model, Part.TRAFFIC, number)
        self.day, self.number = day, number
        self._has_rush = is_weekday(day)
        self._day_log = float(random.normal(0.0, DAY_STD))
        self._own_log = dict(zip(known, own.tolist(), strict=True))
        shape = (int(DAY_S / STEP_S), len(known))
        congestion = gauss_markov(shape, STEP_S, CONGESTION_STD, CONGESTION_S, random)
        self._congestion_log = dict(zip(known, congestion.T, strict=True))

    def speed_mps(self, segment: Segment, time_s: float, run_log: float) -> float:
        """Between standstills on a stretch that is entered at a time, by a driver of this pace."""
        slow_log = self._own_log[segment] + float(self._congestion_log[segment][_step(time_s)])
        slow_log += self._day_log + run_log
        return USUAL_MPS / ((1.0 + self._rushed(time_s)) * math.exp(slow_log))

    def foreseen_mps(
        self, segment: Segment, now_s: float, times_s: Floats, run_log: float, chance: Floats
    ) -> Floats:
        """Speeds at later times, for who knows all but how the congestion of now will change.

        `times_s` and `chance`, of the standard normal distribution, have shape (n,).
        """
        kept = np.exp(-np.maximum(times_s - now_s, 0.0) / CONGESTION_S)
        now_log = float(self._congestion_log[segment][_step(now_s)])
        slow_log = kept * now_log + np.sqrt(1.0 - kept**2) * CONGESTION_STD * chance
        rushed = np.array([self._rushed(time_s) for time_s in times_s.tolist()])
        usual_log = self._own_log[segment] + self._day_log + run_log
        return np.asarray(USUAL_MPS / ((1.0 + rushed) * np.exp(usual_log + slow_log)))

    def _rushed(self, time_s: float) -> float:
        return rush(time_s) if self._has_rush else 0.0


def _step(time_s: float) -> int:
    """Of the congestion's, that an instant of the day lies in."""
    return min(max(int(time_s / STEP_S), 0), int(DAY_S / STEP_S) - 1)
