"""Pure: what is believed of one vehicle, brought forward by events; each aid takes its own kind."""

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, Protocol

import msgspec
import numpy as np

from wayline.agreement import FORGOTTEN_AFTER_NS
from wayline.geo import wrap_360
from wayline.grid import LONGEST_GAP_NS
from wayline.likelihood import Measurement
from wayline.messages import Verdict
from wayline.tuning import Tuning
from wayline_fusion.evidence.learned import Learned
from wayline_fusion.filter.gate import Outcome, verdict
from wayline_fusion.filter.gyro_track import GyroTrack
from wayline_fusion.filter.horizontal import OF_FIX, DrivingNoise, HorizontalFilter
from wayline_fusion.filter.plane import RADIUS_M, moved_along
from wayline_fusion.filter.situation import Situation, Velocity, Waypoint
from wayline_fusion.filter.states import Floats, States
from wayline_fusion.intake.events import Elapsed, Event

WHEELS_FRESH_NS = 2_000_000_000
"""A wheel speed this old no longer says that the vehicle moves or stands."""
ROUNDING_CORRELATION_S = 0.1
"""While driving, the rate goes through a coarse gyro's steps this fast."""
RANGED_NS = 3_000_000_000
"""So long after raw measurements fixes, which are made of them, tell nothing."""
FORGOTTEN_INTERVALS = 3.0
"""Of a source's fixes."""
UNSURE_HEADING_RAD = math.radians(20.0)
"""A way in a direction as unsure is off by more than derivatives say."""
REFLECTED_S = 30.0
"""What fixes are off by more than they claim are reflections, which change along the street."""
OFTEN_S = 11.0
"""Between fixes of which a track of 90 s holds eight, enough for the shape of a way."""
COURSE_HELD_S = 60.0
"""A vehicle that stands for longer may have a course again, or not."""
LONGEST_STEP_NS = 500_000_000
SOUND_EVERY_NS = 1_000_000_000


class Reckoned(NamedTuple):
    """A way in a frame of its own, by what gyro and speed say; without a gyro it goes straight on.

    The gyro's bias is left in it, so that a better one may be taken off all of it later.
    """

    east_m: float
    north_m: float
    heading_rad: float
    """Clockwise from the frame's north."""
    biased_s: float
    """For how long the gyro's bias has turned it."""

    def gone_on(self, rolled_m: float, turned_rad: float, biased_s: float) -> "Reckoned":
        """So far, negative backwards, and turned clockwise meanwhile."""
        middle_rad = self.heading_rad + 0.5 * turned_rad
        return Reckoned(
            self.east_m + rolled_m * math.sin(middle_rad),
            self.north_m + rolled_m * math.cos(middle_rad),
            self.heading_rad + turned_rad,
            self.biased_s + biased_s,
        )


class Snapshot(msgspec.Struct, frozen=True, gc=False):
    """Everything that a rewind sets back."""

    t_ns: int
    distance_m: float
    reckoned: Reckoned
    x: Floats
    P: Floats
    situation: Situation
    learned: Learned
    evidence: tuple[Any, ...]
    """Of each aid, in their order."""


class Aid(Protocol):
    """What one kind of event may do to the state.

    Its docstring says when it starts, goes on, stops and resets.
    """

    evidence: Any
    """Frozen: what it remembers from one event to the next."""

    def take(self, estimate: "Estimate", event: Any) -> Outcome:
        """Use an event at whose instant the estimate is."""
        ...


Manoeuvre = Callable[["Estimate", Measurement, int, int | None], bool]
"""Whether an unlikely speed at an instant can have become of one believed at an earlier instant."""


Unseen = Callable[["Estimate", Measurement], bool]
"""Whether motion that no sensor tells can have led to an unlikely position."""
Turn = Callable[["Estimate", float, float, int | None], bool]
"""Whether a vehicle at a speed (m/s) can have turned so far (rad) since an earlier instant."""


class Estimate:
    """Position, heading, speed and the errors of gyro and odometer."""

    def __init__(
        self,
        tuning: Tuning,
        aids: Mapping[type[Event], Aid],
        kalman: HorizontalFilter | None = None,
    ) -> None:
        self.filter = kalman or HorizontalFilter(tuning)
        self.gyro = GyroTrack()
        self.gyro_rounding_radps = 0.0
        """Std of the gyro's steps."""
        self.t_ns = 0
        """What is believed is believed of this instant; 0 before the first event."""
        self.distance_m = 0.0
        """Travelled since the start."""
        self.reckoned = Reckoned(0.0, 0.0, 0.0, 0.0)
        """The way since the start by turns and speed: no fix moves or turns it."""
        self.situation = Situation()
        self.learned = Learned()
        self.tuning = tuning
        self.verdicts: list[Verdict] = []
        self._aid_of = aids
        self._aids = tuple(aids.values())
        self._turn_noise = math.radians(tuning.gyro_noise_deg_per_sqrt_s)
        self._bias_walk = math.radians(tuning.gyro_bias_walk_degps_per_sqrt_s)
        self._noise_of = (math.nan, math.nan, math.nan)
        self._noise = DrivingNoise(self._turn_noise, self._bias_walk, tuning.gps_error_time_s)
        self._evidence: tuple[Any, ...] | None = None
        self._fresh = self._all_evidence()
        self._sound = self.snapshot()

    @property
    def takes(self) -> frozenset[type[Event]]:
        """The kinds of events that bring it forward."""
        return frozenset(self._aid_of) | {Elapsed}

    def apply(self, event: Event) -> None:
        """Bring the state forward to an event and let its aid take it."""
        self._advance_to(event.t_ns)
        kind = type(event)
        aid = self._aid_of.get(kind)
        if aid is not None:
            before = aid.evidence
            aid.take(self, event)
            if aid.evidence is not before:
                self._evidence = None
        if kind is Elapsed:
            self._keep_sound(event.t_ns)

    def snapshot(self) -> Snapshot:
        """The state, for a rewind; what it holds is never changed in place."""
        kalman = self.filter
        return Snapshot(
            self.t_ns,
            self.distance_m,
            self.reckoned,
            kalman.x,
            kalman.P,
            self.situation,
            self.learned,
            self._all_evidence(),
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Set everything back to a snapshot."""
        self.t_ns, self.distance_m = snapshot.t_ns, snapshot.distance_m
        self.reckoned = snapshot.reckoned
        self.filter.x, self.filter.P = snapshot.x.copy(), snapshot.P.copy()
        self.situation, self.learned = snapshot.situation, snapshot.learned
        self._remind(snapshot.evidence)

    def _all_evidence(self) -> tuple[Any, ...]:
        """Of each aid; made anew only when one has changed."""
        evidence = self._evidence
        if evidence is None:
            evidence = self._evidence = tuple([aid.evidence for aid in self._aids])
        return evidence

    def _remind(self, evidence: tuple[Any, ...]) -> None:
        self._evidence = evidence
        for aid, each in zip(self._aids, evidence, strict=True):
            aid.evidence = each

    def take_verdicts(self) -> list[Verdict]:
        """Verdicts since the last call, those of events applied again after a rewind included."""
        verdicts, self.verdicts = self.verdicts, []
        return verdicts

    @property
    def standing(self) -> bool:
        """Whether the wheels have not turned for long enough."""
        since_ns = self.situation.still_since_ns
        if since_ns is None or not self.wheels_fresh:
            return False
        return self.t_ns - since_ns >= self.tuning.standstill_after_s * 1e9

    @property
    def wheels_fresh(self) -> bool:
        """Whether there is a recent wheel speed."""
        wheels_ns = self.situation.wheels_ns
        return wheels_ns is not None and self.t_ns - wheels_ns <= WHEELS_FRESH_NS

    @property
    def ranged(self) -> bool:
        """Whether raw measurements correct, satellite by satellite."""
        ranged_ns = self.situation.ranged_ns
        return ranged_ns is not None and self.t_ns - ranged_ns <= RANGED_NS

    @property
    def motion_told(self) -> bool:
        """Whether a gyro tells the turns, and wheels or receiver the speed."""
        return self.gyro.covers(self.t_ns) and (self.wheels_fresh or self.speeds_told)

    def way_reckoned(self, *, tells_speed: bool) -> bool:
        """Whether the way from fix to fix is told by gyro and speed, and by no courses.

        Fixes that come seldom are too few for its shape.
        """
        if self.courses_told or self.situation.fix_interval_s > OFTEN_S:
            return False
        return (self.wheels_fresh or tells_speed) and self.gyro.covers(self.t_ns)

    @property
    def speeds_told(self) -> bool:
        """Whether the receiver tells speeds that are believed."""
        told_ns = self.situation.speed_accepted_ns
        told_s = max(COURSE_HELD_S, FORGOTTEN_INTERVALS * self.situation.fix_interval_s)
        return told_ns is not None and self.t_ns - told_ns <= told_s * 1e9

    @property
    def courses_told(self) -> bool:
        """Whether courses hold the heading; otherwise nothing but the positions does."""
        course = self.situation.course
        if course is None:
            return False
        told_s = max(COURSE_HELD_S, FORGOTTEN_INTERVALS * self.situation.fix_interval_s)
        return self.t_ns - course.t_ns <= told_s * 1e9

    @property
    def rejected_forgotten_ns(self) -> int:
        """A rejected part of a fix tells nothing of one that comes so much later."""
        return max(
            FORGOTTEN_AFTER_NS, round(FORGOTTEN_INTERVALS * self.situation.fix_interval_s * 1e9)
        )

    @property
    def located(self) -> bool:
        """Whether position and heading are known."""
        return self.situation.plane is not None and self.situation.heading_known

    def geodetic(self) -> tuple[float, float] | None:
        """Latitude and longitude in degrees; None before the first fix."""
        if self.situation.plane is None:
            return None
        east_m, north_m = self.filter.x[States.EAST], self.filter.x[States.NORTH]
        return self.situation.plane.to_geodetic(float(east_m), float(north_m))

    def heading_deg(self) -> float:
        """Heading, true, clockwise from north."""
        return wrap_360(math.degrees(float(self.filter.x[States.HEADING])))

    def doppler_std_mps(self, ignoring_mps: float, own_mps: float) -> float:
        """Of a receiver's speed as it is to count, before its noise was learned.

        A bad fix is all but ignored (papers/003), as long as what is known without it is any better
        than what its own dilution says of it.
        """
        return own_mps if self.filter.speed_std_mps > own_mps else ignoring_mps

    def know(self, **changes: object) -> None:
        """Replace some of what is known of the situation."""
        self.situation = msgspec.structs.replace(self.situation, **changes)

    def learn(self, **changes: object) -> None:
        """Replace some of what has been learned."""
        self.learned = msgspec.structs.replace(self.learned, **changes)

    def velocity(self) -> Velocity:
        """How the vehicle moves."""
        kalman = self.filter
        heading_rad, std_rad = float(kalman.x[States.HEADING]), kalman.std(States.HEADING)
        return Velocity(kalman.speed_mps, kalman.speed_std_mps, heading_rad, std_rad)

    def pass_waypoint(self) -> None:
        """Remember where the vehicle is, and how it moves."""
        place_deg = self.geodetic()
        if place_deg is not None:
            covariance = self.filter.P[np.ix_(OF_FIX, OF_FIX)]
            self.know(waypoint=Waypoint(self.t_ns, *place_deg, covariance, self.velocity()))

    def driving_noise(self) -> DrivingNoise:
        """What is known of this gyro, learned or configured."""
        steps, learned = self.gyro_rounding_radps, self.learned
        known = steps, learned.wander.factor, learned.claim_factor
        if self._noise_of != known:
            self._noise_of = known
            turn_noise = math.hypot(self._turn_noise, steps * math.sqrt(ROUNDING_CORRELATION_S))
            alike_s = max(self.tuning.gps_error_time_s / learned.claim_factor, REFLECTED_S)
            bias_walk = self._bias_walk * math.sqrt(learned.wander.factor)
            self._noise = DrivingNoise(turn_noise, bias_walk, alike_s)
        return self._noise

    def correct(self, measurement: Measurement) -> None:
        """Correct with a measurement of GPS; without wheels none of them tells of their scale."""
        if self.wheels_fresh:
            self.filter.correct(measurement)
        else:
            self.filter.consider(measurement, States.ODOMETER_SCALE)

    def tell(self, sensor: str, t_ns: int, reason: str) -> None:
        """Say that something known was given up."""
        self.verdicts.append(verdict(sensor, t_ns, reason=reason, accepted=False))

    def start_over(self, t_ns: int) -> None:
        """After a silence that no prediction can bridge only the calibration is still good."""
        self.filter.reset_motion()
        self.t_ns = t_ns
        self.situation = Situation()
        self._remind(self._fresh)

    def _advance_to(self, t_ns: int) -> None:
        began_ns = self.t_ns
        elapsed_ns = t_ns - began_ns
        if began_ns == 0:
            self.t_ns = t_ns
            return
        if elapsed_ns <= 0:
            return
        if elapsed_ns > LONGEST_GAP_NS:
            self.start_over(t_ns)
            return
        kalman, noise, standing = self.filter, self.driving_noise(), self.standing
        steps = -(-elapsed_ns // LONGEST_STEP_NS)
        from_ns = began_ns
        for step in range(1, steps + 1):
            to_ns = began_ns + elapsed_ns * step // steps
            dt_s = (to_ns - from_ns) * 1e-9
            turn_rad = self.gyro.turned_rad(from_ns, to_ns)
            speed_mps = kalman.speed_mps
            kalman.advance(dt_s, turn_rad, noise, standing=standing)
            rolled_m = 0.5 * (speed_mps + kalman.speed_mps) * dt_s
            self.distance_m += abs(rolled_m)
            if turn_rad is None or standing:
                self.reckoned = self.reckoned.gone_on(rolled_m, 0.0, 0.0)
            else:
                turned_rad = kalman.x.item(States.GYRO_SCALE) * turn_rad
                self.reckoned = self.reckoned.gone_on(rolled_m, turned_rad, dt_s)
            from_ns = to_ns
        self.t_ns = t_ns
        x = kalman.x
        if math.hypot(x.item(States.EAST), x.item(States.NORTH)) >= RADIUS_M:
            self._move_plane()

    def _move_plane(self) -> None:
        """Put the origin under the vehicle; north turns by the convergence of the meridians."""
        x = self.filter.x
        moved = moved_along(self.situation.plane, float(x[States.EAST]), float(x[States.NORTH]))
        if moved is not None:
            self.filter.recentre(moved.turn_rad)
            self.know(plane=moved.plane)

    def _keep_sound(self, t_ns: int) -> None:
        """Notice lost numbers; a good state is kept now and then."""
        kalman = self.filter
        # one number that is none makes the whole product none
        if not math.isfinite(kalman.x.dot(kalman.P).dot(kalman.x)):
            self._recover(t_ns)
        elif t_ns - self._sound.t_ns >= SOUND_EVERY_NS:
            self._sound = self.snapshot()

    def _recover(self, t_ns: int) -> None:
        """Start anew with the last calibration that had numbers, and say so."""
        self.filter.x, self.filter.P = self._sound.x.copy(), self._sound.P.copy()
        self.start_over(t_ns)
        self.learned = Learned()
        self.distance_m = self._sound.distance_m
        self.tell("filter", t_ns, "lost its numbers; restarted with the last good calibration")
