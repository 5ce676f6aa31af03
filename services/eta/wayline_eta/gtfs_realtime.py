"""Pure: what is known of vehicles as GTFS-Realtime 2.0: vehicle positions and trip updates.

A trip is named only where it is certain, the vehicle is on its line and stops are yet to come; then
its place is that on the line, which goes on between seldom reports. `uncertainty` of an arrival
is half of what lies between its 10 and its 90 % quantile, in seconds. Times are whole seconds; no
two stops of a trip have the same.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import TypeAlias

from google.transit import gtfs_realtime_pb2 as realtime

from wayline.messages import Arrivals, GpsFix, Pose, StopArrival, TripRun
from wayline_eta.known import Known

VERSION = "2.0"
SECOND_NS = 1_000_000_000
POSITION_S = 90.0
"""A vehicle whose position is older is left out (GTFS-Realtime best practices)."""

Feed: TypeAlias = realtime.FeedMessage
StopTimeUpdate: TypeAlias = realtime.TripUpdate.StopTimeUpdate
Vehicles: TypeAlias = Mapping[str, Known]
"""By id."""


def vehicle_positions(vehicles: Vehicles, monotonic_ns: int, unix_s: int) -> Feed:
    """Where every vehicle is, by two clocks: that of the receipts, and that which readers have."""
    feed = _feed(unix_s)
    for vehicle_id, known in sorted(vehicles.items()):
        heard, run = known.position(monotonic_ns), _run_under_way(known)
        if heard is None or heard.message.lat_deg is None or heard.message.lon_deg is None:
            continue
        if run is not None or heard.age_s(monotonic_ns) <= POSITION_S:
            vehicle = feed.entity.add(id=vehicle_id).vehicle
            vehicle.vehicle.id = vehicle_id
            _place(vehicle, heard.message, unix_s)
            if run is not None:
                _along(vehicle, run, known, unix_s)
    return feed


def trip_updates(vehicles: Vehicles, unix_s: int) -> Feed:
    """When vehicles come to the stops of their trips; a trip is told by one vehicle.

    Trips under way go before those that a vehicle will run next.
    """
    feed = _feed(unix_s)
    told: set[tuple[str, str, str | None]] = set()
    promised = sorted(_promised(vehicles), key=lambda each: (each[0], each[1]))
    for _, vehicle_id, run, arrivals in promised:
        key = run.trip_id, run.start_date, run.start_time
        stops = _stops_of(run, arrivals)
        if key not in told and stops:
            told.add(key)
            entity = feed.entity.add(id=" ".join(filter(None, key)))
            _update(entity.trip_update, vehicle_id, run, vehicles[vehicle_id], unix_s)
    return feed


def _feed(unix_s: int) -> Feed:
    feed = realtime.FeedMessage()
    feed.header.gtfs_realtime_version = VERSION
    feed.header.incrementality = realtime.FeedHeader.FULL_DATASET
    feed.header.timestamp = unix_s
    return feed


def _place(vehicle: realtime.VehiclePosition, at: Pose | GpsFix, unix_s: int) -> None:
    vehicle.timestamp = min(at.t_ns // SECOND_NS, unix_s)
    place = realtime.Position(
        latitude=at.lat_deg,
        longitude=at.lon_deg,
        bearing=at.heading_deg if isinstance(at, Pose) else at.course_deg,
        speed=None if at.speed_mps is None else abs(at.speed_mps),
        odometer=at.distance_m if isinstance(at, Pose) else None,
    )
    vehicle.position.CopyFrom(place)


def _along(vehicle: realtime.VehiclePosition, run: TripRun, known: Known, unix_s: int) -> None:
    """The trip that a vehicle is on, where on it, and the stop that it stands at or comes to."""
    assert known.progress is not None  # what makes a run one under way  # noqa: S101
    assert known.arrivals is not None  # noqa: S101
    progress = known.progress.message
    vehicle.timestamp = min(progress.t_ns // SECOND_NS, unix_s)
    vehicle.position.latitude, vehicle.position.longitude = progress.lat_deg, progress.lon_deg
    _describe(vehicle.trip, run)
    last = known.stop_events[-1] if known.stop_events else None
    if last is not None and last.kind == "arrived" and last.trip_id == run.trip_id:
        vehicle.stop_id, vehicle.current_stop_sequence = last.stop_id, last.stop_sequence
        vehicle.current_status = realtime.VehiclePosition.STOPPED_AT
        return
    for stop in _stops_of(run, known.arrivals.message)[:1]:
        vehicle.stop_id = stop.stop_id
        vehicle.current_stop_sequence = stop.stop_sequence or 0
        vehicle.current_status = realtime.VehiclePosition.IN_TRANSIT_TO


def _run_under_way(known: Known) -> TripRun | None:
    """None where no trip is certain or it is over, or where the vehicle is not on its line."""
    if known.arrivals is None or known.progress is None or known.arrivals.message.stale:
        return None
    arrivals, progress = known.arrivals.message, known.progress.message
    for run in arrivals.runs:
        if run.trip_id == arrivals.trip_id and progress.on_route and _stops_of(run, arrivals):
            return run
    return None


def _promised(vehicles: Vehicles) -> Iterator[tuple[int, str, TripRun, Arrivals]]:
    """Every trip that a vehicle runs, or will run: in how many trips, whose, which."""
    for vehicle_id, known in vehicles.items():
        if known.arrivals is not None and _run_under_way(known) is not None:
            arrivals = known.arrivals.message
            for later, run in enumerate(arrivals.runs):
                yield later, vehicle_id, run, arrivals


def _stops_of(run: TripRun, arrivals: Arrivals) -> list[StopArrival]:
    return [stop for stop in arrivals.stops if (stop.trip_id or arrivals.trip_id) == run.trip_id]


def _describe(trip: realtime.TripDescriptor, run: TripRun) -> None:
    trip.trip_id, trip.route_id, trip.start_date = run.trip_id, run.route_id, run.start_date
    if run.direction_id is not None:
        trip.direction_id = run.direction_id
    if run.start_time is not None:
        trip.start_time = run.start_time
    kind = realtime.TripDescriptor
    trip.schedule_relationship = kind.SCHEDULED if run.exact else kind.UNSCHEDULED


def _update(
    update: realtime.TripUpdate, vehicle_id: str, run: TripRun, known: Known, unix_s: int
) -> None:
    assert known.arrivals is not None  # what makes it promised  # noqa: S101
    arrivals = known.arrivals.message
    _describe(update.trip, run)
    update.vehicle.id = vehicle_id
    position_ns = arrivals.t_ns if arrivals.position_ns is None else arrivals.position_ns
    update.timestamp = min(position_ns // SECOND_NS, unix_s)
    if run.trip_id == arrivals.trip_id:
        if known.progress is not None and known.progress.message.delay_s is not None:
            update.delay = round(known.progress.message.delay_s)
        update.stop_time_update.extend(_left_out(run, known))
    update.stop_time_update.extend(_to_come(run, _stops_of(run, arrivals), unix_s))


def _left_out(run: TripRun, known: Known) -> Iterator[StopTimeUpdate]:
    for event in known.stop_events:
        if event.kind == "skipped" and event.trip_id == run.trip_id:
            yield StopTimeUpdate(
                stop_sequence=event.stop_sequence,
                stop_id=event.stop_id,
                schedule_relationship=StopTimeUpdate.SKIPPED,
            )


def _to_come(run: TripRun, stops: Iterable[StopArrival], unix_s: int) -> Iterator[StopTimeUpdate]:
    """Stops from now on, each at least a second after the one before."""
    kind = StopTimeUpdate.SCHEDULED if run.exact else StopTimeUpdate.UNSCHEDULED
    before_s, sequence = unix_s, -1
    for stop in stops:
        if stop.stop_sequence is None or stop.stop_sequence <= sequence:
            continue
        sequence = stop.stop_sequence
        update = StopTimeUpdate(
            stop_sequence=sequence, stop_id=stop.stop_id, schedule_relationship=kind
        )
        update.arrival.time = max(_whole_s(stop.arrival_ns), before_s + 1)
        departure_ns = stop.arrival_ns if stop.departure_ns is None else stop.departure_ns
        update.departure.time = before_s = max(_whole_s(departure_ns), update.arrival.time)
        uncertainty_s = round((stop.late_ns - stop.early_ns) / (2 * SECOND_NS))
        update.arrival.uncertainty = update.departure.uncertainty = uncertainty_s
        if stop.scheduled_ns is not None and run.exact:
            update.arrival.delay = update.arrival.time - _whole_s(stop.scheduled_ns)
        yield update


def _whole_s(t_ns: int) -> int:
    return round(t_ns / SECOND_NS)
