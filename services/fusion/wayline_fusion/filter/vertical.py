"""Pure: what is believed of altitude and slope, brought forward on fusion's timeline.

The model is the one that the slope map smooths with (`wayline.vertical`). How far the vehicle has
come is read from the horizontal estimate, which is never touched from here.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple, Protocol, runtime_checkable

import msgspec

from wayline.grid import LONGEST_GAP_NS
from wayline.likelihood import Floats, Measurement
from wayline.messages import Verdict
from wayline.noise_scale import NoiseScale
from wayline.tuning import Tuning
from wayline.vertical.filter import VerticalFilter
from wayline.vertical.states import VerticalStates
from wayline_fusion.filter.gate import Outcome
from wayline_fusion.intake.events import Event

S = VerticalStates
PRESSURE_FRESH_NS = 5_000_000_000
"""A pressure this old no longer holds the altitude: 1 Hz is usual, and some are lost."""

ALTITUDE_TOLD_STD_M = 500.0
"""Known worse, no altimeter has told anything."""
TORQUE_FRESH_NS = 5_000_000_000
"""The vehicle's own slope is asked after so long without a torque that was used."""


class Progress(NamedTuple):
    """How far the vehicle has come."""

    t_ns: int
    distance_m: float
    """Travelled since the start."""
    speed_mps: float
    """Negative in reverse."""


class Travelling(Protocol):
    """A horizontal estimate."""

    @property
    def progress(self) -> Progress:
        """How far the vehicle has come."""
        ...


class VerticalAid(Protocol):
    """What one kind of event may do to the altitude, like an `Aid` of the horizontal estimate."""

    evidence: Any

    def take(self, estimate: "VerticalEstimate", event: Any) -> Outcome:
        """Use an event at whose instant the estimate is."""
        ...


@runtime_checkable
class NoisyAid(VerticalAid, Protocol):
    """One that learns how noisy its sensor is, as `noise` of its evidence."""

    sensor: ClassVar[str]
    """As verdicts name it."""


class Height(NamedTuple):
    """Altitude above mean sea level and slope in the direction of travel, positive uphill."""

    alt_m: float | None
    """None where torque alone tells the slope."""
    alt_std_m: float | None
    grade_pct: float
    grade_std_pct: float


class TorqueErrors(NamedTuple):
    """What is known of the slope by torque."""

    bias: float
    """Of the slope, as a tangent."""
    bias_std: float
    mass: float
    """True mass over the stated one."""
    mass_std: float


class Snapshot(msgspec.Struct, frozen=True, gc=False):
    """Everything that a rewind sets back."""

    t_ns: int
    distance_m: float
    known: bool
    x: Floats
    P: Floats
    pressure_ns: int | None
    torque_ns: int | None
    receivers: tuple[str, ...]
    evidence: tuple[Any, ...]


class VerticalEstimate:
    """Altitude, slope and the altimeters' slow errors; nothing is known before an altitude."""

    def __init__(
        self, tuning: Tuning, horizontal: Travelling, aids: Mapping[type[Event], VerticalAid]
    ) -> None:
        self.filter = VerticalFilter(tuning)
        self.tuning = tuning
        self.verdicts: list[Verdict] = []
        self.known = False
        """Whether an altitude has been told."""
        self.t_ns = 0
        self._distance_m = 0.0
        self._pressure_ns: int | None = None
        self._torque_ns: int | None = None
        self._receivers: tuple[str, ...] = ()
        self._horizontal = horizontal
        self._snapshot: Snapshot | None = None
        """Of the state as it is; None once it has changed."""
        self._aid_of = aids
        self._aids = tuple(aids.values())
        self._fresh = self._evidence = tuple(aid.evidence for aid in self._aids)

    @property
    def takes(self) -> frozenset[type[Event]]:
        """The kinds of events that bring it forward."""
        return frozenset(self._aid_of)

    def apply(self, event: Event) -> None:
        """Bring the state forward to an event and let its aid take it."""
        progress = self._horizontal.progress
        # a pressure does not move the horizontal estimate; it goes on as it went
        ahead_s = max(event.t_ns - progress.t_ns, 0) * 1e-9
        distance_m = progress.distance_m + abs(progress.speed_mps) * ahead_s
        self._advance_to(event.t_ns, distance_m, backwards=progress.speed_mps < 0.0)
        self._snapshot = None
        self._aid_of[type(event)].take(self, event)
        self._evidence = tuple([aid.evidence for aid in self._aids])

    def height_at(self, progress: Progress) -> Height | None:
        """Altitude and slope where the vehicle has come to; None before the first altitude."""
        if self.known:
            backwards = progress.speed_mps < 0.0
            self._advance_to(progress.t_ns, progress.distance_m, backwards=backwards)
        if not self.known:
            return None
        kalman = self.filter
        alt_std_m = kalman.std(S.ALTITUDE)
        is_told = alt_std_m < ALTITUDE_TOLD_STD_M
        return Height(
            kalman.x.item(S.ALTITUDE) if is_told else None,
            alt_std_m if is_told else None,
            100.0 * kalman.x.item(S.SLOPE),
            100.0 * kalman.std(S.SLOPE),
        )

    def baro_bias(self) -> tuple[float, float]:
        """Barometric altitude minus altitude, and its std."""
        return self.filter.x.item(S.BARO_BIAS), self.filter.std(S.BARO_BIAS)

    def torque_errors(self) -> TorqueErrors | None:
        """Of the slope by torque; None while no torque has told of a slope."""
        if self._torque_ns is None:
            return None
        kalman = self.filter
        return TorqueErrors(
            kalman.x.item(S.TORQUE_BIAS), kalman.std(S.TORQUE_BIAS), kalman.mass, kalman.mass_std
        )

    def receiver(self, source: str) -> int:
        """The number of a receiver; one that is heard for the first time gets the next."""
        if source not in self._receivers:
            if self._receivers:
                self.filter.add_receiver()
            self._receivers = (*self._receivers, source)
        return self._receivers.index(source)

    @property
    def pressure_fresh(self) -> bool:
        """Whether a barometer holds the altitude."""
        pressure_ns = self._pressure_ns
        return pressure_ns is not None and self.t_ns - pressure_ns <= PRESSURE_FRESH_NS

    def note_pressure(self) -> None:
        """A pressure has just corrected."""
        self._pressure_ns = self.t_ns

    @property
    def torque_fresh(self) -> bool:
        """Whether torques tell of the slope."""
        torque_ns = self._torque_ns
        return torque_ns is not None and self.t_ns - torque_ns <= TORQUE_FRESH_NS

    def note_torque(self) -> None:
        """A torque has just corrected."""
        self._torque_ns = self.t_ns

    def noise_factors(self) -> dict[str, float]:
        """Of the variances that are claimed or configured, as learned so far, by sensor."""
        return {aid.sensor: aid.evidence.noise.factor for aid in self._noisy_aids()}

    def know_noise(self, factors: Mapping[str, float]) -> None:
        """Begin with factors that were learned before, each worth a few measurements."""
        for aid in self._noisy_aids():
            noise = NoiseScale(factor=factors[aid.sensor])
            aid.evidence = msgspec.structs.replace(aid.evidence, noise=noise)
        self._fresh = self._evidence = tuple(aid.evidence for aid in self._aids)
        self._snapshot = None

    def _noisy_aids(self) -> Iterator[NoisyAid]:
        return (aid for aid in self._aids if isinstance(aid, NoisyAid))

    def correct(self, measurement: Measurement) -> None:
        """Update the state."""
        self.filter.correct(measurement)

    def tell(self, sensor: str, t_ns: int, reason: str) -> None:
        """Say that something known was given up."""
        self.verdicts.append(
            Verdict(sensor=sensor, t_ns=t_ns, accepted=False, nis=0.0, threshold=0.0, reason=reason)
        )

    def snapshot(self) -> Snapshot:
        """The state, for a rewind; what it holds is never changed in place."""
        if self._snapshot is None:
            self._snapshot = self._made()
        return self._snapshot

    def _made(self) -> Snapshot:
        kalman = self.filter
        return Snapshot(
            self.t_ns,
            self._distance_m,
            self.known,
            kalman.x,
            kalman.P,
            self._pressure_ns,
            self._torque_ns,
            self._receivers,
            self._evidence,
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Set everything back to a snapshot."""
        self._snapshot = snapshot
        self.t_ns, self._distance_m = snapshot.t_ns, snapshot.distance_m
        self.known, self._receivers = snapshot.known, snapshot.receivers
        self.filter.set(snapshot.x, snapshot.P)
        self._pressure_ns, self._torque_ns = snapshot.pressure_ns, snapshot.torque_ns
        self._remind(snapshot.evidence)

    def take_verdicts(self) -> Sequence[Verdict]:
        """Verdicts since the last call, those of events applied again after a rewind included."""
        verdicts, self.verdicts = self.verdicts, []
        return verdicts

    def _start_over(self) -> None:
        """After a silence that no prediction can bridge nothing is known of the height."""
        self.filter.set(*self.filter.model.first())
        self.known, self._pressure_ns, self._torque_ns = False, None, None
        self._remind(self._fresh)

    def _remind(self, evidence: tuple[Any, ...]) -> None:
        self._evidence = evidence
        for aid, each in zip(self._aids, evidence, strict=True):
            aid.evidence = each

    def _advance_to(self, t_ns: int, distance_m: float, *, backwards: bool) -> None:
        began_ns, began_m = self.t_ns, self._distance_m
        if began_ns and t_ns <= began_ns:
            return
        self._snapshot = None
        self.t_ns, self._distance_m = t_ns, distance_m
        if began_ns and t_ns - began_ns > LONGEST_GAP_NS:
            self._start_over()
        elif began_ns:
            driven_m = max(distance_m - began_m, 0.0)
            elapsed_s = (t_ns - began_ns) * 1e-9
            self.filter.advance(-driven_m if backwards else driven_m, elapsed_s)
