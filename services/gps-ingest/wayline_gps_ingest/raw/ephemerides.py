"""Pure: satellites' places and clocks, for measurements that come without them."""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import msgspec

from wayline.messages import QUANTITY_MAX, RawSatellite
from wayline.satellites.earth import Vector
from wayline_gps_ingest.raw.measured import DISTANCE_MAX_M, DISTANCE_MIN_M, MOTION_MAX_MPS

PSEUDORANGE_MIN_M, PSEUDORANGE_MAX_M = 1.0e6, 1.0e8
"""Others tell nothing of when a signal left: a receiver's clock that was never set."""


class Wanted(NamedTuple):
    """A satellite whose signal was received."""

    system: str
    prn: int
    pseudorange_m: float
    """Tells when the signal left."""


class State(NamedTuple):
    """A satellite when its signal left, earth-fixed in the frame of that instant."""

    place_m: Vector
    motion_mps: Vector
    clock_bias_m: float
    """To be added to the pseudorange; the group delay of its first signal is in it."""
    clock_drift_mps: float
    is_healthy: bool

    @property
    def can_be(self) -> bool:
        """Whether a satellite can be there; damaged ephemerides put it anywhere, or nowhere."""
        return (
            DISTANCE_MIN_M <= self.place_m.length <= DISTANCE_MAX_M
            and self.motion_mps.length <= MOTION_MAX_MPS
            and abs(self.clock_bias_m) <= QUANTITY_MAX
            and abs(self.clock_drift_mps) <= QUANTITY_MAX
        )


class Ephemerides(Protocol):
    """What is known of satellites' orbits and clocks."""

    def states(self, t_ns: int, wanted: Sequence[Wanted]) -> list[State | None]:
        """Satellites whose signals were received at a time (Unix ns), in the order asked for.

        None where there is no ephemeris of that time.
        """
        ...

    def is_known(self, system: str, prn: int) -> bool:
        """Whether there is an ephemeris of a satellite, of whatever time."""
        ...


class Placing:
    """Gives satellites the places, motions and clocks that their ephemerides tell."""

    def __init__(self, ephemerides: Ephemerides) -> None:
        self._ephemerides = ephemerides
        self.placed = 0
        """Satellites of all epochs that have a place."""
        self.without: Counter[str] = Counter()
        """Satellites of all epochs that have none, by reason: `without ephemeris`, `ephemeris too
        old`, `ephemeris damaged`, `without pseudorange`, and `unhealthy`: not to be used."""

    def satellites(self, t_ns: int, measured: Sequence[RawSatellite]) -> tuple[RawSatellite, ...]:
        """The satellites measured at a time (Unix ns), with all that is known of them."""
        wanted = [Wanted(each.system, each.prn, each.pseudorange_m or 0.0) for each in measured]
        states = self._ephemerides.states(t_ns, wanted)
        return tuple(map(self._with_state, measured, wanted, states))

    def _with_state(
        self, satellite: RawSatellite, wanted: Wanted, state: State | None
    ) -> RawSatellite:
        why_not = self._why_not(wanted, state)
        if why_not is not None or state is None:
            self.without[why_not or ""] += 1
            return satellite
        self.placed += 1
        x_m, y_m, z_m = state.place_m
        vx_mps, vy_mps, vz_mps = state.motion_mps
        return msgspec.structs.replace(
            satellite,
            x_m=x_m,
            y_m=y_m,
            z_m=z_m,
            vx_mps=vx_mps,
            vy_mps=vy_mps,
            vz_mps=vz_mps,
            clock_bias_m=state.clock_bias_m,
            clock_drift_mps=state.clock_drift_mps,
        )

    def _why_not(self, wanted: Wanted, state: State | None) -> str | None:
        """Why a satellite is left without a place; None where it has one."""
        if not PSEUDORANGE_MIN_M < wanted.pseudorange_m < PSEUDORANGE_MAX_M:
            return "without pseudorange"
        if state is None:
            is_known = self._ephemerides.is_known(wanted.system, wanted.prn)
            return "ephemeris too old" if is_known else "without ephemeris"
        if not state.can_be:
            return "ephemeris damaged"
        return None if state.is_healthy else "unhealthy"
