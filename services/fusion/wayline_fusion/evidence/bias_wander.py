"""Pure: how fast this gyro's bias wanders, learned from the courses of the fixes.

Course minus measured turn changes by bias times time, whatever the filter believes. Its slope over
one minute, compared with that over the next, is the Allan variance of the gyro (IEEE Std 952,
rate random walk: K^2 tau / 3), besides what the courses and the angle random walk add.
"""

from typing import NamedTuple

import msgspec

from wayline.geo import wrap_pi

BIN_NS = 10_000_000_000
"""Courses are averaged over this time; shorter than what is looked for, longer than their noise."""
BIN_COURSES_MIN = 4
"""A bin with fewer tells too little."""
SPAN_MIN_S, SPAN_MAX_S = 55.0, 150.0
"""Of one slope: shorter, the courses' noise hides the wander; longer, too few a drive."""
SAMPLE_WEIGHT = 0.25
"""Slopes that begin every ten seconds overlap; so much is new in each."""
PRIOR_WEIGHT = 2.0
"""The configured wander counts as so many independent samples."""
WEIGHT_MAX = 30.0
"""Samples are forgotten over so many further ones."""
LEAST, MOST = 0.5, 8.0
"""Times the configured wander: cheap gyros are four times worse than automotive ones."""
SAMPLE_MAX = 9.0
"""One sample counts as three sigma at most: tyres slip, antennas see reflections."""


class Walk(NamedTuple):
    """What is configured and known of the gyro, in radians."""

    bias_per_sqrt_s: float
    angle_per_sqrt_s: float
    bias: float
    scale: float
    scale_std: float


class Courses(NamedTuple):
    """Means over one bin."""

    t_ns: int
    course_rad: float
    """With whole turns."""
    course_variance: float
    turn_rad: float
    """Measured, uncorrected, since the gyro began."""
    fixes: int

    def offset_rad(self, scale: float) -> float:
        """Course minus measured turn."""
        return self.course_rad - scale * self.turn_rad


class BiasWander(msgspec.Struct, frozen=True):
    """Random walk of the bias: `factor` is the square of the configured one's multiple."""

    factor: float = 1.0
    weight: float = PRIOR_WEIGHT
    bins: tuple[Courses, ...] = ()
    """The last one is still being filled."""

    def forgotten(self) -> "BiasWander":
        """After a gap in the measured turn the courses before it tell nothing."""
        return BiasWander(self.factor, self.weight)

    def noticed(
        self, t_ns: int, course_rad: float, course_std_rad: float, turn_rad: float, walk: Walk
    ) -> "BiasWander":
        """With one more heading by the fixes, and the turn measured since the gyro began."""
        variance = course_std_rad**2
        if not self.bins:
            return self._with(Courses(t_ns, course_rad, variance, turn_rad, 1))
        last = self.bins[-1]
        elapsed_s = (t_ns - last.t_ns) * 1e-9
        predicted = last.course_rad + walk.scale * (
            turn_rad - last.turn_rad - walk.bias * elapsed_s
        )
        course_rad = predicted + wrap_pi(course_rad - predicted)
        if t_ns - last.t_ns >= BIN_NS:
            return self._closed(walk)._with(Courses(t_ns, course_rad, variance, turn_rad, 1))
        fixes = last.fixes + 1
        filled = Courses(
            last.t_ns,
            last.course_rad + (course_rad - last.course_rad) / fixes,
            last.course_variance + (variance - last.course_variance) / fixes,
            last.turn_rad + (turn_rad - last.turn_rad) / fixes,
            fixes,
        )
        return BiasWander(self.factor, self.weight, (*self.bins[:-1], filled))

    def _with(self, begun: Courses) -> "BiasWander":
        oldest_ns = begun.t_ns - round(2e9 * SPAN_MAX_S)
        kept = [each for each in self.bins if each.t_ns >= oldest_ns]
        if kept and kept[-1].fixes < BIN_COURSES_MIN:
            kept.pop()
        return BiasWander(self.factor, self.weight, (*kept, begun))

    def _closed(self, walk: Walk) -> "BiasWander":
        """Compare the slopes before and after the bin about a minute before the full one."""
        if self.bins[-1].fixes < BIN_COURSES_MIN:
            return self
        last = self.bins[-1]
        middle = _before(self.bins, last.t_ns)
        first = None if middle is None else _before(self.bins, middle.t_ns)
        if middle is None or first is None:
            return self
        return self._learned(Slope(first, middle), Slope(middle, last), walk)

    def _learned(self, one: "Slope", two: "Slope", walk: Walk) -> "BiasWander":
        moved = two.rate_radps(walk.scale) - one.rate_radps(walk.scale)
        other = _other_variance(one, two, walk)
        configured = walk.bias_per_sqrt_s**2 * (one.span_s + two.span_s) / 3.0
        expected = self.factor * configured
        sample = (min(moved**2, SAMPLE_MAX * (other + expected)) - other) / configured
        share = SAMPLE_WEIGHT * expected / (expected + other)
        weight = min(self.weight + share, WEIGHT_MAX)
        factor = self.factor + (sample - self.factor) * share / weight
        return BiasWander(min(max(factor, LEAST**2), MOST**2), weight, self.bins)


class Slope(NamedTuple):
    """From one bin to another."""

    begin: Courses
    end: Courses

    @property
    def span_s(self) -> float:
        """Time between the two."""
        return (self.end.t_ns - self.begin.t_ns) * 1e-9

    def rate_radps(self, scale: float) -> float:
        """Course minus measured turn, in time: minus the gyro's bias."""
        return (self.end.offset_rad(scale) - self.begin.offset_rad(scale)) / self.span_s

    @property
    def turning_radps(self) -> float:
        """Measured."""
        return (self.end.turn_rad - self.begin.turn_rad) / self.span_s


def _other_variance(one: Slope, two: Slope, walk: Walk) -> float:
    """What courses, angle random walk and the doubt of the scale do to the slopes' difference."""
    per_one, per_two = 1.0 / one.span_s, 1.0 / two.span_s
    return (
        one.begin.course_variance / one.begin.fixes * per_one**2
        + one.end.course_variance / one.end.fixes * (per_one + per_two) ** 2
        + two.end.course_variance / two.end.fixes * per_two**2
        + walk.angle_per_sqrt_s**2 * (per_one + per_two)
        + (walk.scale_std * (two.turning_radps - one.turning_radps)) ** 2
    )


def _before(bins: tuple[Courses, ...], t_ns: int) -> Courses | None:
    """The newest bin that is old enough, and not too old."""
    for each in reversed(bins):
        age_s = (t_ns - each.t_ns) * 1e-9
        if age_s >= SPAN_MIN_S:
            return each if age_s <= SPAN_MAX_S else None
    return None
