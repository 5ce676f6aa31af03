"""Pure: cuts what a vehicle drives into trips, live and from the store alike."""

import datetime as dt
import math
from collections import deque
from dataclasses import dataclass, field

from wayline.geo import step_between
from wayline.messages import LIST_MAX, SPEED_MAX_MPS, Trip, TripStop
from wayline_history.climb import Climb
from wayline_history.samples import Sample
from wayline_history.travelled import SourcedFix, Travelled, honest

PARK_NS = 300_000_000_000
"""A vehicle that stands so long has arrived; queues and lights are shorter."""
ENGINE_OFF_NS = 120_000_000_000
"""One whose engine stands still so long too: what stops it at lights is shorter."""
SILENCE_NS = 300_000_000_000
"""Not heard so long, or nobody knew where: where it went meanwhile is no part of a trip."""
TRIP_MIN_M = 100.0
"""One that never was so far from its start was shunted, or only its position wandered."""
EXTENT_SIGMAS = 3.0
RECENT_NS = 60_000_000_000
FAR_M = 1_000.0
"""How much farther than this it was changes nothing."""
MOVES_MPS = 1.0
STANDS_MPS = 0.5
"""Between the two it goes on doing what it did."""
STOP_MIN_S = 10.0
"""A stand this long is a stop on the way."""


def trip_key(vehicle_id: str, started_ns: int) -> str:
    """The name of the trip of a vehicle that began at an instant; unlike any other's."""
    started = dt.datetime.fromtimestamp(started_ns // 1_000_000_000, dt.UTC)
    return f"{vehicle_id}_{started:%Y%m%dT%H%M%SZ}"


@dataclass(slots=True)
class _Stand:
    """A vehicle that stands, and what is only part of its trip if it drives on."""

    first: Sample
    outage_ns: int = 0
    engine_off_ns: int | None = None
    """Since when."""


@dataclass(slots=True)
class _OpenTrip:
    """A trip under way."""

    start: Sample
    last: Sample
    travelled: Travelled
    climb: Climb = field(default_factory=Climb)
    moving_ns: int = 0
    max_speed_mps: float = 0.0
    extent_m: float = 0.0
    outage_ns: int = 0
    stops: list[TripStop] = field(default_factory=list)
    stand: _Stand | None = None

    def drive(self, sample: Sample) -> None:
        """Add the way to a sample at which the vehicle moves."""
        stand, self.stand = self.stand, None
        if stand is not None:
            self.outage_ns += stand.outage_ns
            self._stop(stand, sample)
        self.climb.take(sample.t_ns, sample.alt_m, sample.alt_std_m)
        self.moving_ns += sample.t_ns - self.last.t_ns
        speed_mps = min(abs(sample.speed_mps or 0.0), SPEED_MAX_MPS)
        self.max_speed_mps = max(self.max_speed_mps, speed_mps)
        if self.extent_m < FAR_M:
            self.extent_m = max(self.extent_m, _apart_m(self.start, sample))

    def rest(self, sample: Sample) -> None:
        """Add a sample at which the vehicle stands."""
        if self.stand is None:
            self.drive(sample)
            self.stand = _Stand(sample)
        if not sample.is_engine_off:
            self.stand.engine_off_ns = None
        elif self.stand.engine_off_ns is None:
            self.stand.engine_off_ns = sample.t_ns

    def miss(self, lasted_ns: int) -> None:
        """Count a time without accepted fixes."""
        if self.stand is None:
            self.outage_ns += lasted_ns
        else:
            self.stand.outage_ns += lasted_ns

    def _stop(self, stand: _Stand, sample: Sample) -> None:
        dwell_s = (sample.t_ns - stand.first.t_ns) * 1e-9
        if dwell_s >= STOP_MIN_S and len(self.stops) < LIST_MAX:
            first = stand.first
            self.stops.append(
                TripStop(
                    started_ns=first.t_ns,
                    dwell_s=round(dwell_s, 3),
                    lat_deg=first.lat_deg,
                    lon_deg=first.lon_deg,
                )
            )


class TripCutter:
    """Takes the poses of one vehicle in order of time and gives a trip when it has ended.

    A trip ends where the vehicle has stood for five minutes, or for two with its engine off, and
    where it was silent for five; its end is when it began to stand or was last heard.
    """

    def __init__(self, vehicle_id: str) -> None:
        self._vehicle_id = vehicle_id
        self._before: Sample | None = None
        self._open: _OpenTrip | None = None
        self._refused_ns: deque[int] = deque()
        """When measurements were refused that may be of the trip under way, or of the next."""
        self._fixes: deque[SourcedFix] = deque()
        """The newest, which may be of the next trip."""
        self._was_lost = False
        """Since the sample before nobody knew where it was."""

    @property
    def is_open(self) -> bool:
        """Whether a trip is under way, of which time alone may be the end."""
        return self._open is not None

    def fix(self, sourced: SourcedFix) -> None:
        """A fix of a receiver, in any order."""
        self._fixes.append(sourced)
        while sourced.fix.t_ns - self._fixes[0].fix.t_ns > RECENT_NS:
            self._fixes.popleft()
        if self._open is not None:
            self._open.travelled.fix(sourced)

    def refuse(self, t_ns: int) -> None:
        """A measurement of an instant was refused."""
        self._refused_ns.append(t_ns)
        while not self.is_open and t_ns - self._refused_ns[0] > SILENCE_NS:
            self._refused_ns.popleft()

    def take(self, sample: Sample | None) -> Trip | None:
        """The next pose (None: of unknown place); one that is not later changes nothing."""
        before = self._before
        if sample is None:
            self._was_lost = True
            return None
        if before is not None and sample.t_ns <= before.t_ns:
            return None
        ended = self.pass_time(sample.t_ns)
        if before is not None and sample.t_ns - before.t_ns > SILENCE_NS:
            before = None
        self._go_on(before or sample, sample)
        self._before, self._was_lost = sample, False
        return self._parked(sample) or ended

    def pass_time(self, t_ns: int) -> Trip | None:
        """Time has come so far without a pose."""
        is_silent = self._before is not None and t_ns - self._before.t_ns > SILENCE_NS
        return self.finish() if is_silent else None

    def finish(self) -> Trip | None:
        """The trip under way ends here."""
        trip, self._open = self.under_way, None
        return trip

    @property
    def under_way(self) -> Trip | None:
        """The trip that goes on, as far as it has come; None where there is none yet."""
        return None if self._open is None else self._told(self._open)

    def _go_on(self, before: Sample, sample: Sample) -> None:
        is_moving = self._moves(sample)
        if self._open is None:
            if not is_moving:
                return
            self._open = _OpenTrip(before, before, Travelled(before, list(self._fixes)))
            self._open.climb.take(before.t_ns, before.alt_m, before.alt_std_m)
        if self._was_lost or sample.mode == "dead_reckoning":
            self._open.miss(sample.t_ns - before.t_ns)
        if sample is not before:
            self._open.travelled.pose(sample)
        if is_moving:
            self._open.drive(sample)
            self._open.travelled.measure(sample.t_ns)
        else:
            self._open.rest(sample)
        self._open.last = sample

    def _moves(self, sample: Sample) -> bool:
        was_moving = self._open is not None and self._open.stand is None
        if sample.speed_mps is None:
            return was_moving
        least_mps = STANDS_MPS if was_moving else MOVES_MPS
        return abs(sample.speed_mps) >= least_mps

    def _parked(self, sample: Sample) -> Trip | None:
        stand = None if self._open is None else self._open.stand
        if stand is None:
            return None
        off_ns = stand.engine_off_ns
        has_parked = sample.t_ns - stand.first.t_ns >= PARK_NS
        is_off = off_ns is not None and sample.t_ns - off_ns >= ENGINE_OFF_NS
        return self.finish() if has_parked or is_off else None

    def _told(self, trip: _OpenTrip) -> Trip | None:
        start, end = trip.start, trip.last if trip.stand is None else trip.stand.first
        unsure_m = EXTENT_SIGMAS * max(start.position_std_m, end.position_std_m)
        if trip.extent_m < max(TRIP_MIN_M, unsure_m):
            return None
        distance_m, distance_std_m = honest(trip.travelled.way_to(end.t_ns))
        climb_m, climb_std_m = trip.climb.known
        return Trip(
            t_ns=end.t_ns,
            trip_key=trip_key(self._vehicle_id, start.t_ns),
            started_ns=start.t_ns,
            ended_ns=end.t_ns,
            distance_m=round(distance_m, 2),
            distance_std_m=round(distance_std_m, 2),
            climb_m=None if climb_m is None else round(climb_m, 1),
            climb_std_m=None if climb_std_m is None else round(climb_std_m, 1),
            moving_s=round(trip.moving_ns * 1e-9, 3),
            max_speed_mps=trip.max_speed_mps,
            start_lat_deg=start.lat_deg,
            start_lon_deg=start.lon_deg,
            end_lat_deg=end.lat_deg,
            end_lon_deg=end.lon_deg,
            rejected=sum(start.t_ns <= t_ns <= end.t_ns for t_ns in self._refused_ns),
            outage_s=round(trip.outage_ns * 1e-9, 3),
            stops=tuple(trip.stops),
        )


def _apart_m(one: Sample, other: Sample) -> float:
    if math.hypot(one.lat_deg - other.lat_deg, one.lon_deg - other.lon_deg) == 0.0:
        return 0.0
    return step_between(one.lat_deg, one.lon_deg, other.lat_deg, other.lon_deg).distance_m
