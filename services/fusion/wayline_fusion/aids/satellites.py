"""Pure: satellites, one by one: corrected with, refused, or begun from."""

import math

import msgspec
import numpy as np

from wayline.agreement import Agreement, lasted_s, rejected
from wayline.geo import LocalPlane
from wayline.likelihood import Measurement, threshold
from wayline_fusion.evidence.single_epoch import fix_alone
from wayline_fusion.evidence.range_fit import Heard, RangeFit, RangeTrack
from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import TOO_FAR, UNUSED, Outcome, verdict
from wayline_fusion.filter.range_noise import one_sided
from wayline_fusion.filter.ranges import (
    Lines,
    judged,
    offset_state,
    pseudorange_lines,
    range_rate_lines,
)
from wayline_fusion.filter.ranging import RangingStates
from wayline_fusion.filter.sight import Ground, Sight, ground_at, seen_from
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import Ranges, parts_of

S, R = States, RangingStates
MILLISECOND_M = 299_792.458
SAME_REFLECTIONS_S = 30.0
SAME_REFLECTIONS_M = 15.0


class RangeEvidence(msgspec.Struct, frozen=True):
    """What earlier epochs have shown."""

    plane: LocalPlane | None = None
    """About which the track lies."""
    track: RangeTrack = RangeTrack()
    used_ns: int = 0
    used_m: float = 0.0
    systems: frozenset[str] = frozenset()
    """Whose time is known."""
    rejected: Agreement | None = None


class Satellites:
    """Pseudoranges and range rates of one epoch."""

    def __init__(self) -> None:
        self.evidence = RangeEvidence()

    def take(self, estimate: Estimate, epoch: Ranges) -> Outcome:
        self._remember(estimate, epoch)
        if not estimate.located:
            self._begin(estimate, epoch)
        if estimate.located:
            self._correct(estimate, epoch)
        return UNUSED

    def _keep(self, **changes: object) -> None:
        self.evidence = msgspec.structs.replace(self.evidence, **changes)

    def _remember(self, estimate, epoch):
        reckoned = estimate.reckoned
        heard = Heard(epoch, complex(reckoned.east_m, reckoned.north_m), reckoned.biased_s)
        self.now = heard
        track = self.evidence.track.with_epoch(heard)
        self._keep(track=track)

    def _begin(self, estimate, epoch):
        alone = fix_alone(epoch)
        self.alone = alone
        kalman = estimate.filter
        if alone is not None:
            fix, height = alone
            kalman.reset_ranging(R.HEIGHT, height, 30.0)
            for part in parts_of(fix):
                estimate.apply(part)
        place = estimate.geodetic()
        if place is None:
            return
        h0 = float(kalman.x[R.HEIGHT])
        ground = ground_at(*place, h0)
        fit = self.evidence.track.fit(self.now, ground, 0.0, math.radians(1.0))
        self.fit = fit
        if fit is None: return
        if fit.turn_std_rad > math.radians(8.0): return
        plane = estimate.situation.plane
        x = kalman.x
        e, n = float(x[S.EAST]) + fit.place_m.real, float(x[S.NORTH]) + fit.place_m.imag
        heading = estimate.reckoned.heading_rad + fit.turn_rad
        kalman.reset_reckoning((e, n, heading, fit.bias_radps), fit.covariance)
        kalman.reset_ranging(R.HEIGHT, h0 + fit.height_m, 15.0)
        estimate.know(heading_known=True, placed_ns=epoch.t_ns, accepted_fix_ns=epoch.t_ns)
        self._keep(systems=frozenset())

    def _correct(self, estimate, epoch):
        kalman, tuning = estimate.filter, estimate.tuning
        ground = ground_at(*estimate.geodetic(), float(kalman.x[R.HEIGHT]))
        sight = seen_from(ground, epoch.places_m, epoch.motions_mps)
        slow = 1.9
        lines = pseudorange_lines(kalman.x, epoch, sight, slow)
        fresh = set(epoch.systems) - self.evidence.systems
        if fresh:
            for system in sorted(fresh, key=lambda s: s != "gps"):
                self._set_time(estimate, epoch, lines, system)
            self._keep(systems=self.evidence.systems | fresh)
            lines = pseudorange_lines(kalman.x, epoch, sight, slow)
        H = lines.H
        expected = H @ kalman.P @ H.T
        limit = threshold(1, tuning.gate_probability)
        verdicts = judged(lines.y, expected + np.diag(lines.stds**2), limit)
        for i, name in enumerate(epoch.names):
            ok = bool(verdicts.is_accepted[i])
            estimate.verdicts.append(verdict(name, epoch.t_ns, float(verdicts.off[i] ** 2), limit, reason=None if ok else TOO_FAR, accepted=ok))
        kept = np.flatnonzero(verdicts.is_accepted)
        if not len(kept): return
        weights = one_sided(verdicts.off[kept], 1.0)
        dt = (epoch.t_ns - self.evidence.used_ns) * 1e-9
        dm = estimate.distance_m - self.evidence.used_m
        news = 1.0 - math.exp(-dt / SAME_REFLECTIONS_S - dm / SAME_REFLECTIONS_M)
        noise = lines.stds[kept]**2 / np.maximum(weights, 1e-4) / news
        estimate.correct(Measurement("gps_raw", lines.y[kept], H[kept], np.diag(noise)))
        self._keep(used_ns=epoch.t_ns, used_m=estimate.distance_m)
        estimate.know(accepted_fix_ns=epoch.t_ns, ranged_ns=epoch.t_ns)

    def _set_time(self, estimate, epoch, lines, system):
        kalman = estimate.filter
        rows = np.array([s == system for s in epoch.systems])
        state = offset_state(system) or R.CLOCK
        y = lines.y[rows]
        base = 0.0 if state == R.CLOCK else float(kalman.x[R.CLOCK])
        kalman.reset_ranging(state, float(np.median(y)) - (0 if state == R.CLOCK else base) + (0 if state == R.CLOCK else 0), 30.0)
