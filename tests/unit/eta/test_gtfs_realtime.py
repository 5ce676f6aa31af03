"""Vehicles as GTFS-Realtime: what readers of the feeds are told, and when it is made anew."""

from typing import Any

import msgspec
from fastapi.testclient import TestClient
from google.transit import gtfs_realtime_pb2 as realtime

from unit.eta.route_drives import SECOND_NS, START_NS
from wayline.http_settings import HttpSettings
from wayline.messages import (
    Arrivals,
    GpsFix,
    Pose,
    Progress,
    StopArrival,
    StopEvent,
    StopEventKind,
    TripRun,
)
from wayline.view import Receipt
from wayline_eta.app import create_eta_app
from wayline_eta.board import EtaBoard
from wayline_eta.gtfs_realtime import POSITION_S
from wayline_eta.realtime_feeds import positions_feed, updates_feed

NOW_S = START_NS // SECOND_NS
RUN = TripRun(trip_id="t1", route_id="5A", direction_id=1, start_date="20231114")
NEXT = TripRun(trip_id="t2", route_id="5A", start_date="20231114")


class Clock:
    def __init__(self) -> None:
        self.now_ns = START_NS

    def __call__(self) -> int:
        return self.now_ns


def stop(
    sequence: int, arrives_s: float, *, departs_s: float | None = None, trip_id: str | None = None
) -> StopArrival:
    return StopArrival(
        stop_id=f"s{sequence}",
        name=f"Stop {sequence}",
        distance_m=100.0,
        arrival_ns=START_NS + round(arrives_s * SECOND_NS),
        early_ns=START_NS + round((arrives_s - 20.0) * SECOND_NS),
        late_ns=START_NS + round((arrives_s + 40.0) * SECOND_NS),
        departure_ns=START_NS + round((departs_s or arrives_s) * SECOND_NS),
        scheduled_ns=START_NS + round((arrives_s - 90.0) * SECOND_NS),
        stop_sequence=sequence,
        trip_id=trip_id,
    )


def arrivals(*stops: StopArrival, runs: tuple[TripRun, ...] = (RUN,)) -> Arrivals:
    return Arrivals(t_ns=START_NS, route_id="5A", trip_id="t1", stale=False, stops=stops, runs=runs)


PROGRESS = Progress(
    t_ns=START_NS,
    route_id="5A",
    trip_id="t1",
    distance_m=500.0,
    lat_deg=39.9,
    lon_deg=-75.3,
    cross_track_m=4.0,
    distance_std_m=5.0,
    on_route=True,
    speed_mps=7.0,
    delay_s=90.0,
)
POSE = Pose(
    t_ns=START_NS,
    mode="fused",
    lat_deg=39.95,
    lon_deg=-75.35,
    heading_deg=80.0,
    speed_mps=-1.0,
    distance_m=1234.0,
)


def happened(sequence: int, kind: StopEventKind, trip_id: str = "t1") -> StopEvent:
    return StopEvent(
        t_ns=START_NS,
        route_id="5A",
        trip_id=trip_id,
        stop_id=f"s{sequence}",
        stop_sequence=sequence,
        kind=kind,
        distance_m=0.0,
    )


def board_of(clock: Clock, *messages: Any, vehicle_id: str = "bus-1") -> EtaBoard:
    board = EtaBoard(clock)
    put(board, clock, *messages, vehicle_id=vehicle_id)
    return board


def put(board: EtaBoard, clock: Clock, *messages: Any, vehicle_id: str = "bus-1") -> None:
    for message in messages:
        board.put(vehicle_id, message, "", Receipt(clock()))


def updates(board: EtaBoard, clock: Clock) -> list[realtime.FeedEntity]:
    feed = realtime.FeedMessage()
    feed.ParseFromString(updates_feed(board, clock).bytes_of("protobuf"))
    return list(feed.entity)


def positions(board: EtaBoard, clock: Clock) -> list[realtime.FeedEntity]:
    feed = realtime.FeedMessage()
    feed.ParseFromString(positions_feed(board, clock).bytes_of("protobuf"))
    return list(feed.entity)


def test_a_trip_update_has_times_delays_and_half_the_range() -> None:
    clock = Clock()
    board = board_of(clock, PROGRESS, arrivals(stop(3, 60.4, departs_s=75.0), stop(4, 200.0)))
    (entity,) = updates(board, clock)
    update = entity.trip_update
    assert (update.trip.trip_id, update.trip.start_date, update.trip.direction_id) == (
        "t1", "20231114", 1,
    )  # fmt: skip
    assert (update.vehicle.id, update.delay, update.timestamp) == ("bus-1", 90, NOW_S)
    first, second = update.stop_time_update
    assert (first.stop_sequence, first.stop_id) == (3, "s3")
    assert (first.arrival.time, first.arrival.delay, first.arrival.uncertainty) == (
        NOW_S + 60, 90, 30,
    )  # fmt: skip
    assert first.departure.time == NOW_S + 75
    assert second.arrival.time == NOW_S + 200


def test_stops_left_out_are_told_and_those_that_were_served_are_not() -> None:
    clock = Clock()
    board = board_of(
        clock, PROGRESS, happened(1, "passed"), happened(2, "skipped"), happened(3, "passed"),
        arrivals(stop(4, 60.0)),
    )  # fmt: skip
    (entity,) = updates(board, clock)
    told = [(each.stop_sequence, each.schedule_relationship) for each in
            entity.trip_update.stop_time_update]  # fmt: skip
    kinds = realtime.TripUpdate.StopTimeUpdate
    assert told == [(2, kinds.SKIPPED), (4, kinds.SCHEDULED)]
    put(board, clock, happened(1, "passed", "t2"))
    (entity,) = updates(board, clock)
    assert len(entity.trip_update.stop_time_update) == 1, "of another trip"


def test_what_was_left_out_of_the_trip_before_is_not_told_of_the_next() -> None:
    clock = Clock()
    following = msgspec.structs.replace(arrivals(stop(1, 60.0), runs=(NEXT,)), trip_id="t2")
    board = board_of(clock, PROGRESS, happened(2, "skipped"), following)
    (entity,) = updates(board, clock)
    assert [each.stop_sequence for each in entity.trip_update.stop_time_update] == [1]


def test_of_stops_that_were_served_the_last_is_known() -> None:
    clock = Clock()
    board = board_of(clock, *(happened(sequence, "passed") for sequence in range(1, 9)))
    known, _ = board.look_at_all()
    assert [event.stop_sequence for event in known["bus-1"].stop_events] == [8]


def test_times_are_after_now_and_each_after_the_one_before() -> None:
    clock = Clock()
    board = board_of(clock, PROGRESS, arrivals(stop(3, 0.0), stop(4, 0.0), stop(5, 0.6)))
    (entity,) = updates(board, clock)
    times_s = [each.arrival.time - NOW_S for each in entity.trip_update.stop_time_update]
    assert times_s == [1, 2, 3]


def test_a_trip_is_told_once_by_the_vehicle_that_runs_it() -> None:
    clock = Clock()
    later = arrivals(stop(5, 60.0), stop(1, 500.0, trip_id="t2"), runs=(RUN, NEXT))
    board = board_of(clock, PROGRESS, later)
    assert [each.trip_update.trip.trip_id for each in updates(board, clock)] == ["t1", "t2"]
    assert [each.trip_update.HasField("delay") for each in updates(board, clock)] == [True, False]
    own = msgspec.structs.replace(arrivals(stop(2, 80.0), runs=(NEXT,)), trip_id="t2")
    put(board, clock, PROGRESS, own, vehicle_id="bus-9")
    told = {each.trip_update.trip.trip_id: each.trip_update.vehicle.id for each in
            updates(board, clock)}  # fmt: skip
    assert told == {"t1": "bus-1", "t2": "bus-9"}


def test_old_positions_uncertain_trips_and_vehicles_off_their_line_promise_nothing() -> None:
    clock = Clock()
    said = arrivals(stop(3, 60.0))
    for change, progress in (
        ({"stale": True}, PROGRESS),
        ({"runs": (), "trip_id": None}, PROGRESS),
        ({"stops": ()}, PROGRESS),
        ({}, msgspec.structs.replace(PROGRESS, on_route=False)),
    ):
        board = board_of(clock, POSE, progress, msgspec.structs.replace(said, **change))
        assert not updates(board, clock)
        (entity,) = positions(board, clock)
        assert not entity.vehicle.HasField("trip")
        assert entity.vehicle.position.latitude == realtime.Position(latitude=39.95).latitude


def test_a_vehicle_on_its_trip_is_where_it_is_along_it() -> None:
    clock = Clock()
    board = board_of(clock, POSE, PROGRESS, arrivals(stop(3, 60.0)))
    (entity,) = positions(board, clock)
    vehicle = entity.vehicle
    assert round(vehicle.position.latitude, 4) == 39.9
    assert (vehicle.position.bearing, vehicle.position.speed) == (80.0, 1.0)
    status = realtime.VehiclePosition
    assert (vehicle.stop_id, vehicle.current_status) == ("s3", status.IN_TRANSIT_TO)
    put(board, clock, happened(2, "arrived"))
    (entity,) = positions(board, clock)
    assert (entity.vehicle.stop_id, entity.vehicle.current_status) == ("s2", status.STOPPED_AT)
    put(board, clock, happened(2, "departed"))
    (entity,) = positions(board, clock)
    assert entity.vehicle.stop_id == "s3"


def test_old_positions_are_left_out() -> None:
    clock = Clock()
    fix = GpsFix(t_ns=START_NS, valid=True, lat_deg=39.9, lon_deg=-75.3, course_deg=10.0)
    board = board_of(clock, fix)
    (entity,) = positions(board, clock)
    assert (entity.id, entity.vehicle.position.bearing) == ("bus-1", 10.0)
    clock.now_ns += round((POSITION_S + 1.0) * SECOND_NS)
    assert not positions(board, clock)


def test_repeated_trips_say_when_they_begin_and_promise_no_times() -> None:
    clock = Clock()
    repeated = msgspec.structs.replace(RUN, start_time="07:30:00", exact=False)
    board = board_of(clock, PROGRESS, arrivals(stop(3, 60.0), runs=(repeated,)))
    (entity,) = updates(board, clock)
    trip, (update,) = entity.trip_update.trip, entity.trip_update.stop_time_update
    assert (trip.start_time, trip.schedule_relationship) == (
        "07:30:00", realtime.TripDescriptor.UNSCHEDULED,
    )  # fmt: skip
    assert update.schedule_relationship == realtime.TripUpdate.StopTimeUpdate.UNSCHEDULED
    assert not update.arrival.HasField("delay")


def test_a_feed_is_made_once_a_second_and_its_time_never_goes_back() -> None:
    clock = Clock()
    board = board_of(clock, PROGRESS, arrivals(stop(3, 60.0)))
    feed = updates_feed(board, clock)
    first = feed.bytes_of("protobuf")
    put(board, clock, arrivals(stop(3, 90.0)))
    assert feed.bytes_of("protobuf") == first
    clock.now_ns += SECOND_NS
    second = feed.bytes_of("protobuf")
    assert second != first
    clock.now_ns -= 10 * SECOND_NS
    assert feed.bytes_of("protobuf") == second


def test_over_http_it_is_protobuf_or_json() -> None:
    clock = Clock()
    board = board_of(clock, POSE, PROGRESS, arrivals(stop(3, 60.0)))
    http = TestClient(create_eta_app(board, [], HttpSettings()), base_url="http://localhost")
    answer = http.get("/gtfs-rt/trip-updates")
    assert answer.headers["content-type"] == "application/x-protobuf"
    feed = realtime.FeedMessage.FromString(answer.content)
    assert feed.header.gtfs_realtime_version == "2.0"
    assert feed.entity[0].trip_update.trip.trip_id == "t1"
    told = http.get("/gtfs-rt/vehicle-positions?format=json").json()
    assert told["entity"][0]["vehicle"]["vehicle"]["id"] == "bus-1"
    assert http.get("/gtfs-rt/vehicle-positions?format=xml").status_code == 422
