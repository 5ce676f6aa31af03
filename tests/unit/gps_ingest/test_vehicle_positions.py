"""GTFS-Realtime vehicle positions: what is read of them, and whom an agency's names are."""

import math

import pytest
from google.protobuf import json_format

from agency import NOON_S, Bus, feed_of, payload_of
from wayline.inputs import PositionReport
from wayline.vehicle_ids import vehicle_id_of
from wayline_gps_ingest.agency import Agency
from wayline_gps_ingest.vehicle_positions import NotRealtimeError, read_vehicle_positions

SECOND_NS = 10**9
WHOLE = Bus("8062", 38.9072, -77.0369, NOON_S - 7, "868590120", 271.5, 8.25)
REPORT = PositionReport(
    (NOON_S - 7) * SECOND_NS, 38.9072, -77.0369, 271.5, 8.25, assignment="868590120"
)


def test_a_report_is_read_from_protobuf_and_from_json() -> None:
    feed = feed_of([WHOLE])
    for payload in (
        feed.SerializeToString(),
        json_format.MessageToJson(feed).encode(),
        b"\xef\xbb\xbf"
        + json_format.MessageToJson(feed, preserving_proto_field_name=True).encode(),
    ):
        snapshot = read_vehicle_positions(payload)
        assert snapshot.told_ns == NOON_S * SECOND_NS
        assert [told.report for told in snapshot.vehicles] == [REPORT]
        assert snapshot.vehicles[0].names["trip_id"] == "868590120"


def test_what_is_not_told_is_unknown() -> None:
    (told,) = read_vehicle_positions(payload_of([Bus("7", told_s=0)])).vehicles
    assert told.report == PositionReport(NOON_S * SECOND_NS, 38.9, -77.0), "the feed's own time"


def test_a_vehicle_without_an_id_goes_by_its_label_or_its_entity() -> None:
    feed = feed_of([Bus(""), Bus("")])
    feed.entity[0].vehicle.vehicle.label = "12/A"
    assert [told.vehicle for told in read_vehicle_positions(feed.SerializeToString()).vehicles] == [
        "12/A",
        "1",
    ]


def test_what_has_no_place_or_is_deleted_is_no_report() -> None:
    feed = feed_of([Bus("1"), Bus("2"), Bus("3"), Bus("4")])
    feed.entity[0].vehicle.ClearField("position")
    feed.entity[1].vehicle.position.latitude = math.nan
    feed.entity[2].is_deleted = True
    snapshot = read_vehicle_positions(feed.SerializeToString())
    assert [told.vehicle for told in snapshot.vehicles] == ["4"]
    assert snapshot.unplaced == 2


@pytest.mark.parametrize(
    ("payload", "words"),
    [
        (b"<!doctype html><title>Sign in</title>", "web page"),
        (b" \n<?xml version='1.0'?><Error/>", "web page"),
        (b'{"error": "no such key"}', "neither"),
        (b"{", "neither"),
        (b"\xff\xfe\x00rubbish", "neither"),
        (b"", "nothing"),
        (b"time,lat,lon\n1,2,3\n", "neither"),
    ],
)
def test_what_is_no_feed_is_called_what_it_seems(payload: bytes, words: str) -> None:
    with pytest.raises(NotRealtimeError, match=words):
        read_vehicle_positions(payload)


@pytest.mark.parametrize(
    ("name", "vehicle_id"),
    [
        ("Bus 12/A", "bus-12-a"),
        ("8062", "8062"),
        (" y1234 ", "y1234"),
        ("_7", "7"),
        ("Straßenbahn 4", "stra-enbahn-4"),
        ("", None),
        ("***", None),
        ("x" * 65, None),
    ],
)
def test_an_agency_s_name_becomes_a_vehicle_id(name: str, vehicle_id: str | None) -> None:
    assert vehicle_id_of(name) == vehicle_id


def taken(
    agency: Agency, buses: list[Bus], told_s: int, received_s: int | None = None
) -> list[str]:
    """Whose reports were new."""
    snapshot = read_vehicle_positions(payload_of(buses, told_s))
    received_ns = None if received_s is None else received_s * SECOND_NS
    return [vehicle_id for vehicle_id, _ in agency.take(snapshot, received_ns)]


def test_a_report_is_passed_on_once_however_often_it_is_told() -> None:
    agency = Agency()
    assert taken(agency, [Bus("1"), Bus("2")], NOON_S) == ["1", "2"]
    assert taken(agency, [Bus("1", told_s=NOON_S + 20)], NOON_S) == [], "an unchanged header"
    assert taken(agency, [Bus("1"), Bus("2", told_s=NOON_S + 20)], NOON_S + 30) == ["2"]
    assert taken(agency, [Bus("1", told_s=NOON_S - 9)], NOON_S + 15) == [], "an older copy"
    assert agency.faults == {}


def test_what_is_out_of_order_doubled_or_of_the_future_is_counted_and_dropped() -> None:
    agency = Agency()
    assert taken(agency, [Bus("1"), Bus("1", told_s=NOON_S - 5)], NOON_S) == ["1"]
    assert agency.faults == {"earlier": 1}
    assert taken(agency, [Bus("1", told_s=NOON_S + 3600)], NOON_S + 30) == []
    assert agency.faults == {"earlier": 1, "ahead": 1}
    assert taken(agency, [Bus("1", told_s=NOON_S + 60)], NOON_S + 60) == ["1"], "no harm is left"
    assert taken(agency, [Bus("1", 0.0, 0.0, NOON_S + 90)], NOON_S + 90) == []
    assert agency.faults["no place"] == 1


def test_a_feed_of_the_future_is_dropped_whole_and_leaves_nothing_behind() -> None:
    agency = Agency()
    year_s = NOON_S + 365 * 86_400
    assert taken(agency, [Bus("1", told_s=year_s)], year_s, received_s=NOON_S) == []
    assert agency.faults == {"ahead": 1}
    assert taken(agency, [Bus("1")], NOON_S, received_s=NOON_S) == ["1"]


def test_two_names_that_become_one_id_are_not_mixed() -> None:
    agency = Agency()
    both = [Bus("Bus 12/A", 38.9), Bus("bus-12-a", 39.0, told_s=NOON_S + 1)]
    assert taken(agency, both, NOON_S + 1) == ["bus-12-a"]
    assert agency.faults == {"two with one id": 1}
    assert taken(agency, [Bus("***")], NOON_S + 30) == []
    assert agency.faults["no id"] == 1
