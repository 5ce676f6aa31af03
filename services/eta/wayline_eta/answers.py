"""Pure: what is known of vehicles as the answers over HTTP and to Zenoh queries (SPEC section 5).

Instants are RFC 3339 in UTC with milliseconds, on the vehicle's own clock, that is of the drive
where a recording is played. Ages and seconds to go are counted from now whatever that clock says.
"""

import msgspec

from wayline.messages import Arrivals, GpsFix, Pose, PoseMode, Progress, StopArrival
from wayline.rfc3339 import rfc3339
from wayline_eta.known import Heard, Known


class PositionAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """Where a vehicle is, by fusion's pose or, while fusion is silent, by a receiver's fix."""

    t: str
    source: str
    mode: PoseMode | None
    """Of the pose; null of a fix."""
    lat_deg: float
    lon_deg: float
    alt_m: float | None
    heading_deg: float | None
    """A fix's is its course."""
    speed_mps: float | None
    east_std_m: float | None
    north_std_m: float | None


class ProgressAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """Where a vehicle is along its route."""

    t: str
    route_id: str
    trip_id: str | None
    distance_m: float
    lap: int
    lat_deg: float
    lon_deg: float
    cross_track_m: float
    distance_std_m: float
    speed_mps: float
    delay_s: float | None
    """Behind the timetable; null without one."""


class VehicleAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """A vehicle; what was never heard of it is null."""

    vehicle_id: str
    age_s: float | None
    """Of the position."""
    on_route: bool | None
    position: PositionAnswer | None
    progress: ProgressAnswer | None


class VehicleList(msgspec.Struct, frozen=True):
    """Every vehicle that was ever heard, by id."""

    vehicles: tuple[VehicleAnswer, ...]


class ArrivalAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """A vehicle's next arrival at a stop: median, and the 10 and 90 % quantiles."""

    stop_id: str
    name: str
    vehicle_id: str
    route_id: str
    trip_id: str | None
    headsign: str | None
    """Of the trip under way; null of a later one."""
    distance_m: float
    """Along the route from where the vehicle was when this was predicted."""
    arrival: str
    early: str
    late: str
    departure: str | None
    scheduled: str | None
    """By the timetable; null without one."""
    delay_s: float | None
    """How much later than that; negative is early."""
    confidence: str | None
    """learned, timetable or planned."""
    seconds: float
    """From now to the arrival; 0 where it is due."""
    age_s: float
    """Age of the position that this rests on."""
    stale: bool
    """The position that this rests on is old."""


class ArrivalList(msgspec.Struct, frozen=True):
    """Arrivals, soonest first."""

    arrivals: tuple[ArrivalAnswer, ...]


def vehicle_answer(vehicle_id: str, known: Known, now_ns: int) -> VehicleAnswer:
    """A vehicle as it is known."""
    heard = known.position(now_ns)
    progress = known.progress.message if known.progress else None
    return VehicleAnswer(
        vehicle_id=vehicle_id,
        age_s=round(heard.age_s(now_ns), 3) if heard else None,
        on_route=progress.on_route if progress else None,
        position=_position(heard) if heard else None,
        progress=progress_answer(progress) if progress else None,
    )


def _position(heard: Heard[Pose] | Heard[GpsFix]) -> PositionAnswer | None:
    at = heard.message
    if at.lat_deg is None or at.lon_deg is None:
        return None
    pose = at if isinstance(at, Pose) else None
    return PositionAnswer(
        t=rfc3339(at.t_ns),
        source=heard.source,
        mode=pose.mode if pose else None,
        lat_deg=at.lat_deg,
        lon_deg=at.lon_deg,
        alt_m=at.alt_m,
        heading_deg=at.heading_deg if isinstance(at, Pose) else at.course_deg,
        speed_mps=at.speed_mps,
        east_std_m=pose.east_std_m if pose else None,
        north_std_m=pose.north_std_m if pose else None,
    )


def progress_answer(progress: Progress) -> ProgressAnswer:
    """Progress as it was told."""
    return ProgressAnswer(
        t=rfc3339(progress.t_ns),
        route_id=progress.route_id,
        trip_id=progress.trip_id,
        distance_m=progress.distance_m,
        lap=progress.lap,
        lat_deg=progress.lat_deg,
        lon_deg=progress.lon_deg,
        cross_track_m=progress.cross_track_m,
        distance_std_m=progress.distance_std_m,
        speed_mps=progress.speed_mps,
        delay_s=progress.delay_s,
    )


def arrival_answers(
    vehicle_id: str, known: Known, now_ns: int, stop_id: str | None = None
) -> list[ArrivalAnswer]:
    """A vehicle's next arrivals as its last `arrivals` message has them, at one stop or all."""
    if known.arrivals is None:
        return []
    arrivals = known.arrivals.message
    # the vehicle's clock now: recordings are years behind, so no wall clock can tell
    vehicle_now_ns = arrivals.t_ns + round(known.arrivals.since_s(now_ns) * 1e9)
    position_ns = arrivals.t_ns if arrivals.position_ns is None else arrivals.position_ns
    age_s = known.arrivals.age_s(now_ns) + (arrivals.t_ns - position_ns) * 1e-9
    return [
        _arrival(vehicle_id, arrivals, stop, vehicle_now_ns, age_s)
        for stop in arrivals.stops
        if stop_id is None or stop.stop_id == stop_id
    ]


def _arrival(
    vehicle_id: str, arrivals: Arrivals, stop: StopArrival, vehicle_now_ns: int, age_s: float
) -> ArrivalAnswer:
    scheduled_ns, departure_ns = stop.scheduled_ns, stop.departure_ns
    late_ns = None if scheduled_ns is None else stop.arrival_ns - scheduled_ns
    return ArrivalAnswer(
        stop_id=stop.stop_id,
        name=stop.name,
        vehicle_id=vehicle_id,
        route_id=arrivals.route_id,
        trip_id=stop.trip_id or arrivals.trip_id,
        headsign=arrivals.headsign if stop.trip_id is None else None,
        distance_m=stop.distance_m,
        arrival=rfc3339(stop.arrival_ns),
        early=rfc3339(stop.early_ns),
        late=rfc3339(stop.late_ns),
        departure=None if departure_ns is None else rfc3339(departure_ns),
        scheduled=None if scheduled_ns is None else rfc3339(scheduled_ns),
        delay_s=None if late_ns is None else round(late_ns * 1e-9, 1),
        confidence=stop.confidence,
        seconds=round(max(stop.arrival_ns - vehicle_now_ns, 0) * 1e-9, 3),
        age_s=round(age_s, 3),
        stale=arrivals.stale,
    )


def soonest_first(arrivals: list[ArrivalAnswer]) -> ArrivalList:
    """Arrivals by seconds to go: vehicles of recordings have clocks of their own."""
    return ArrivalList(tuple(sorted(arrivals, key=lambda at: (at.seconds, at.vehicle_id))))
