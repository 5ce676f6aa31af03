"""Pure: satellites, one by one: corrected with, refused, or begun from."""

import math

import msgspec
import numpy as np

from wayline.agreement import Agreement, lasted_s, rejected
from wayline.likelihood import Measurement, threshold
from wayline.satellites.sight import Ground, ground_at
from wayline.snooping import Judged, judged
from wayline_fusion.evidence.range_fit import Heard, Known, RangeFit, RangeTrack
from wayline_fusion.evidence.single_epoch import fix_alone
from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome
from wayline_fusion.filter.ranges import (
    MILLISECOND_M,
    Lines,
    clock_step_m,
    lines_of,
    verdicts_of,
    weights_of,
)
from wayline_fusion.filter.ranging import DRIFT_UNKNOWN_MPS, RangingFilter, RangingStates
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import Ranges, parts_of

S, R = States, RangingStates
SURE_HEADING_RAD = math.radians(7.0)
"""From there on the filter, which goes straight on from one place, does better than a fit."""
UNSURE_HEADING_RAD = math.radians(20.0)
"""Of a filter that satellites have locked out."""
STEPPED_STD_M = 100.0
"""Of a clock that has stepped by what satellites among reflections say."""
HEIGHT_ALONE_STD_M = 30.0
"""Of a single epoch's."""


class RangeEvidence(msgspec.Struct, frozen=True):
    """What earlier epochs have shown."""

    track: RangeTrack = RangeTrack()
    is_settled: bool = False
    """The heading has been sure once, and satellites have not spoken against it since."""
    used_ns: int = 0
    used_m: float = 0.0
    """When, and after how far a way, ranges corrected last."""
    rejected: Agreement | None = None
    """Epochs most of whose ranges were refused."""


class Satellites:
    """Pseudoranges and range rates of one epoch, each judged by itself.

    Starts: a fix by one epoch alone begins what fixes begin; with gyro and wheels the ranges of the
    last two minutes, laid over the reckoned way, set place and heading until the heading is sure.
    Goes on: each likely range and rate corrects, a reflected one alone is refused; those that are
    rather too long count for less, and all count for as much as reflections have changed since.
    Stops: no satellite is told of. Resets: when most are refused together, the clock has stepped;
    if that is not it for `relock_at_once_s`, place and heading are doubted and laid out anew.
    """

    def __init__(self) -> None:
        self.evidence = RangeEvidence()

    def take(self, estimate: Estimate, epoch: Ranges) -> Outcome:
        """Begin with an epoch where nothing is known, else correct with each of its satellites."""
        if not estimate.located or estimate.situation.position_unconfirmed:
            _begin(estimate, epoch)
        if not self.evidence.is_settled:
            self._settle(estimate, epoch)
        ground = _ground(estimate)
        if ground is not None and estimate.located:
            self._correct(estimate, epoch, ground)
        return UNUSED

    def _keep(self, **changes: object) -> None:
        self.evidence = msgspec.structs.replace(self.evidence, **changes)

    def _settle(self, estimate: Estimate, epoch: Ranges) -> None:
        """Remember an epoch, and set place and heading to where all have the reckoned way."""
        ground = _ground(estimate)
        if ground is None or not estimate.way_reckoned(tells_speed=False):
            self._keep(track=RangeTrack())
            return
        before, heard = self.evidence.track, _heard(estimate, epoch)
        track = before.with_epoch(heard)
        if track is before:
            return
        self._keep(track=track)
        fit = track.fit(heard, ground, _known(estimate))
        sure_rad = math.radians(estimate.tuning.heading_start_std_deg)
        if fit is None or fit.turn_std_rad > sure_rad:
            return
        _place(estimate, fit)
        if fit.turn_std_rad <= SURE_HEADING_RAD:
            self._keep(is_settled=True, track=RangeTrack())

    def _correct(self, estimate: Estimate, epoch: Ranges, ground: Ground) -> None:
        lines, found = self._judge(estimate, epoch, ground)
        limit = threshold(1, estimate.tuning.gate_probability)
        estimate.verdicts += verdicts_of(lines, found, epoch.t_ns, limit)
        kept = found.is_accepted
        ranged = kept & lines.is_range
        if kept.any():
            noise = np.diag(self._variances(estimate, lines, found)[kept])
            estimate.correct(Measurement("gps_raw", lines.y[kept], lines.H[kept], noise))
        if ranged.any():
            self._keep(used_ns=epoch.t_ns, used_m=estimate.distance_m)
            estimate.know(ranged_ns=epoch.t_ns)
        # with the height known, as many as east, north and a clock for each system
        if np.count_nonzero(ranged) >= 2 + len({epoch.systems[row] for row in lines.rows[ranged]}):
            estimate.know(accepted_fix_ns=epoch.t_ns)
        self._watch(estimate, epoch, lines, found)

    def _judge(self, estimate: Estimate, epoch: Ranges, ground: Ground) -> tuple[Lines, Judged]:
        """As they are; where the clock has stepped, after that."""
        lines, found = _judged(estimate, epoch, ground)
        step_m = clock_step_m(lines, found)
        if step_m is None:
            return lines, found
        kalman = _filter(estimate)
        before = kalman.x, kalman.P
        kalman.step_clock(step_m)
        if step_m % MILLISECOND_M:
            # no receiver's own correction: its crystal does something else now
            kalman.reset_ranging(R.CLOCK, STEPPED_STD_M)
            kalman.reset_ranging(R.CLOCK_DRIFT, DRIFT_UNKNOWN_MPS)
        again = _judged(estimate, epoch, ground)
        if again[1].refused_share(again[0].is_range) > 0.5:
            kalman.x, kalman.P = before
            return lines, found
        estimate.tell("gps_raw_clock", epoch.t_ns, f"the clock has stepped by {step_m:,.0f} m")
        return again

    def _variances(self, estimate: Estimate, lines: Lines, found: Judged) -> np.ndarray:
        """What each counts for: too long ones for less, and none twice for one reflection."""
        evidence, tuning = self.evidence, estimate.tuning
        driven = (estimate.distance_m - evidence.used_m) / tuning.reflection_way_m
        waited = (estimate.t_ns - evidence.used_ns) * 1e-9 / tuning.reflection_time_s
        new = 1.0 - math.exp(-waited - driven)
        counted = weights_of(lines, found) * np.where(lines.is_range, new, 1.0)
        return lines.stds**2 / np.maximum(counted, 1e-6)

    def _watch(self, estimate: Estimate, epoch: Ranges, lines: Lines, found: Judged) -> None:
        """Notice that satellites lock the filter out, and open it."""
        if found.refused_share(lines.is_range) <= 0.5:
            self._keep(rejected=None)
            return
        streak = rejected(self.evidence.rejected, epoch.t_ns)
        self._keep(rejected=streak)
        if lasted_s(streak, epoch.t_ns) < estimate.tuning.relock_at_once_s:
            return
        off_m = float(np.median(np.abs(lines.y[lines.is_range])))
        estimate.filter.inflate_position(off_m)
        estimate.filter.inflate_std(S.HEADING, UNSURE_HEADING_RAD)
        estimate.tell("gps_raw", epoch.t_ns, "most satellites refused for long; place doubted")
        self._keep(rejected=None, is_settled=False)


def _heard(estimate: Estimate, epoch: Ranges) -> Heard:
    reckoned = estimate.reckoned
    return Heard(epoch, complex(reckoned.east_m, reckoned.north_m), reckoned.biased_s)


def _known(estimate: Estimate) -> Known:
    kalman, tuning = estimate.filter, estimate.tuning
    bias_radps, std_radps = float(kalman.x[S.GYRO_BIAS]), kalman.std(S.GYRO_BIAS)
    return Known(bias_radps, std_radps, tuning.range_std_floor_m)


def _ground(estimate: Estimate) -> Ground | None:
    place_deg = estimate.geodetic()
    if place_deg is None:
        return None
    return ground_at(*place_deg, float(estimate.filter.x[R.HEIGHT]))


def _begin(estimate: Estimate, epoch: Ranges) -> None:
    """Let a fix by this epoch alone go the way of any fix."""
    alone = fix_alone(epoch, estimate.tuning.range_std_floor_m)
    if alone is None:
        return
    fix, height_m = alone
    _filter(estimate).reset_ranging(R.HEIGHT, HEIGHT_ALONE_STD_M, height_m)
    for part in parts_of(fix):
        estimate.apply(part)


def _place(estimate: Estimate, fit: RangeFit) -> None:
    """Set what a fit tells; it is given about where the filter has the vehicle."""
    kalman = _filter(estimate)
    east_m = float(kalman.x[S.EAST]) + fit.place_m.real
    north_m = float(kalman.x[S.NORTH]) + fit.place_m.imag
    heading_rad = estimate.reckoned.heading_rad + fit.turn_rad
    kalman.reset_reckoning((east_m, north_m, heading_rad, fit.bias_radps), fit.covariance)
    kalman.reset_ranging(R.HEIGHT, fit.height_std_m, float(kalman.x[R.HEIGHT]) + fit.height_m)
    estimate.know(heading_known=True, placed_ns=estimate.t_ns, accepted_fix_ns=estimate.t_ns)


def _filter(estimate: Estimate) -> RangingFilter:
    """The architecture has given it this one."""
    kalman = estimate.filter
    if not isinstance(kalman, RangingFilter):
        raise TypeError("satellites need a filter with a clock")
    return kalman


def _judged(estimate: Estimate, epoch: Ranges, ground: Ground) -> tuple[Lines, Judged]:
    kalman, tuning = estimate.filter, estimate.tuning
    turn_radps = estimate.gyro.rate_radps(epoch.t_ns) or 0.0
    lines = lines_of(kalman.x, epoch, ground, turn_radps, tuning)
    covariance = kalman.expected(Measurement("gps_raw", lines.y, lines.H, np.empty(0)))
    covariance[np.diag_indices(len(lines.y))] += lines.stds**2
    return lines, judged(lines.y, covariance, threshold(1, tuning.gate_probability))
