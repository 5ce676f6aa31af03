"""Pure: fixes and vehicle sensors in, pose and fusion_status out."""

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import msgspec

from wayline.core import Record
from wayline.drive import Vehicle
from wayline.inputs import Flush, Tick
from wayline.messages import Barometer, GpsFix, GpsRaw, Gyro, Message, Odometer, Torque
from wayline.tuning import Tuning
from wayline_fusion.architectures.choice import chosen
from wayline_fusion.coupling.aider import Aider
from wayline_fusion.evidence.slopes_told import SlopesTold
from wayline_fusion.filter.timeline import Timeline
from wayline_fusion.intake.events import Elapsed, Event, Ranges
from wayline_fusion.intake.intake import Intake
from wayline_fusion.intake.told import Told
from wayline_fusion.keeping.keeper import Keeper
from wayline_fusion.keeping.records import Saved
from wayline_fusion.outputs import Fixes, Outputs

Taker = Callable[[Any, str], Sequence[Message | Record]]
"""Takes one kind of input."""

CAR = Vehicle()
"""Where nobody has said what the vehicle is."""
SECOND_NS = 1_000_000_000


class FusionCore:
    """One vehicle's pose, ten times a second with CAN, else once a fix.

    `saved` is what was kept of this very vehicle; records of it say what to keep. What the
    vehicle weighs and how the air holds it back says what torque tells of the slope.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset(
        {GpsFix, GpsRaw, Odometer, Gyro, Barometer, Torque}
    )
    period_ns: ClassVar[int | None] = 100_000_000

    def __init__(self, tuning: Tuning, saved: Saved | None = None, vehicle: Vehicle = CAR) -> None:
        self._estimator, self._vertical, self._keeper = chosen(tuning, saved)
        self._beginning: Keeper | None = self._keeper
        """Until what was kept is taken up."""
        depth_ns = round(tuning.late_measurement_s * 1e9)
        self._timeline: Timeline[Event] = Timeline((self._estimator, self._vertical), depth_ns)
        self._told = Told()
        self._intake = Intake(tuning, self._told, self._estimator, vehicle)
        self._slopes = SlopesTold()
        self._outputs = Outputs(
            self._estimator,
            self._vertical,
            self._told,
            self._slopes,
            tuning,
            mass_kg=vehicle.mass_kg,
        )
        self._aider = Aider()
        self._fix_delay_ns = 0
        """How much older than the newest event a fix is when it comes."""
        self._pose_ns = 0
        self._takers: dict[type[msgspec.Struct], Taker] = {
            Gyro: self._gyro,
            Odometer: self._odometer,
            GpsFix: self._gps_fix,
            GpsRaw: self._gps_raw,
            Barometer: self._barometer,
            Torque: self._torque,
            Tick: self._tick,
            Flush: self._flush,
        }

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
        """Take a fix, a sensor's message or a Tick; return the poses and status due."""
        taker = self._takers.get(type(message))
        return () if taker is None else taker(message, source)

    def _is_refused(self, message: Message, source: str) -> bool:
        """Whether a reading cannot be; first of all a step of the clock is noticed."""
        intake = self._intake
        step_s = intake.step_of_clock_s(message)
        if step_s is not None:
            self._add(intake.clock_step(step_s))
        reason = intake.refusal(message, source)
        if reason is not None:
            intake.refuse(message, reason)
            return True
        if self._beginning is not None and self._beginning.begin(message.t_ns):
            self._beginning = None
        return False

    def _gyro(self, gyro: Gyro, source: str) -> Sequence[Message]:
        if self._is_refused(gyro, source):
            return ()
        if gyro.temperature_c is not None:
            restarted = self._keeper.take_temperature(gyro.t_ns, gyro.temperature_c)
            if restarted is not None:
                self._add(restarted)
            warmed = self._intake.warmed(gyro)
            if warmed is not None:
                self._add(warmed)
        self._intake.gyro(gyro)
        return ()

    def _odometer(self, odometer: Odometer, source: str) -> Sequence[Message]:
        if not self._is_refused(odometer, source):
            wheel_speed = self._intake.wheel_speed(odometer)
            if wheel_speed is not None:
                self._add(wheel_speed)
            push = self._intake.push(odometer)
            if push is not None:
                self._add(push)
        return ()

    def _torque(self, torque: Torque, source: str) -> Sequence[Message]:
        if not self._is_refused(torque, source):
            reported = self._intake.torque(torque)
            if reported is not None:
                self._add(reported)
        return ()

    def _gps_fix(self, fix: GpsFix, source: str) -> Sequence[Message]:
        if self._is_refused(fix, source):
            return ()
        if fix.geoid_sep_m is not None:
            self._aider.geoid_sep_m = fix.geoid_sep_m
        return self._located(fix.t_ns, self._intake.fix(fix, source))

    def _gps_raw(self, epoch: GpsRaw, source: str) -> Sequence[Message]:
        self._aider.take(epoch, source)
        if Ranges not in self._estimator.takes or self._is_refused(epoch, source):
            return ()
        return self._located(epoch.t_ns, self._intake.ranges(epoch))

    def _located(self, t_ns: int, events: Sequence[Event]) -> Sequence[Message]:
        """Apply what a receiver has told of an instant, and tell what has become of it."""
        if not events:
            return ()
        self._fix_delay_ns = max(self._estimator.progress.t_ns - t_ns, 0)
        self._add(*events)
        # after a late fix the state is not that of its instant but of the last event
        now_ns = self._estimator.progress.t_ns
        if self._has_can(t_ns) or now_ns <= self._pose_ns:
            return [self._outputs.status(t_ns)]
        return [self._pose(now_ns, has_can=False), self._outputs.status(t_ns)]

    def _barometer(self, barometer: Barometer, source: str) -> Sequence[Message]:
        if not self._is_refused(barometer, source):
            pressure = self._intake.pressure(barometer)
            if pressure is not None:
                self._add(pressure)
        return ()

    def _tick(self, tick: Tick, _: str) -> Sequence[Message | Record]:
        t_ns = tick.t_ns
        self._add(Elapsed(t_ns))
        messages: list[Message | Record] = []
        on_second = t_ns % SECOND_NS == 0
        fix_ns = self._intake.fix_ns
        without_fix = fix_ns is None or t_ns - fix_ns > SECOND_NS
        has_can = self._has_can(t_ns)
        if t_ns > self._pose_ns and (has_can or (on_second and without_fix)):
            messages.append(self._pose(t_ns, has_can=has_can))
        if self._aider.is_needed:
            messages += self._aider.due(t_ns, self._outputs.carried())
        if on_second:
            messages.append(self._outputs.status(t_ns))
        messages += self._keeper.due(t_ns, self._intake.heard_ns)
        return messages

    def _flush(self, _: Flush, __: str) -> Sequence[Record]:
        return self._keeper.last(self._intake.heard_ns)

    def _add(self, *events: Event) -> None:
        """Apply events of one instant, and tell their own verdicts."""
        if not self._timeline.add(*events):
            self._told.late += 1
        for event in events:
            self._slopes.take(event, self._estimator.progress)
        t_ns = events[0].t_ns
        self._told.add(self._estimator.take_verdicts(), t_ns)
        if self._vertical.verdicts:
            self._told.add(self._vertical.take_verdicts(), t_ns)

    def _pose(self, t_ns: int, *, has_can: bool) -> Message:
        self._pose_ns = t_ns
        fixes = Fixes(self._intake.cadence.usual_s, self._fix_delay_ns)
        return self._outputs.pose(t_ns, fixes, has_can=has_can)

    def _has_can(self, t_ns: int) -> bool:
        vehicle_ns = self._intake.vehicle_ns
        heard = vehicle_ns is not None and t_ns - vehicle_ns <= SECOND_NS
        return heard and self._estimator.uses_vehicle
