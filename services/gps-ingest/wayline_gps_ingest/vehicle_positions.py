"""Pure: GTFS-Realtime vehicle positions, in protobuf or its JSON, as position reports."""

import math
from typing import NamedTuple

import numpy as np
from google.protobuf import json_format
from google.protobuf.message import DecodeError
from google.transit import gtfs_realtime_pb2 as realtime

from wayline.inputs import PositionReport
from wayline.messages import EARLIEST_NS, LATEST_NS

SECOND_NS = 1_000_000_000


class NotRealtimeError(ValueError):
    """The bytes are no GTFS-Realtime feed; says what they seem to be."""


class VehicleReport(NamedTuple):
    """Where a vehicle is, under the names that its agency has for it."""

    vehicle: str
    """Its id; its label, or the entity's id, where it has none."""
    names: dict[str, str]
    """By what recordings are asked for: vehicle_id, label, license_plate, trip_id, route_id."""
    report: PositionReport


class Snapshot(NamedTuple):
    """What a feed says at an instant."""

    told_ns: int | None
    """When it was put together; None where it does not say."""
    vehicles: tuple[VehicleReport, ...]
    unplaced: int
    """Entities of vehicles without a position or a time."""


def read_vehicle_positions(payload: bytes) -> Snapshot:
    """Decode a feed. Raises NotRealtimeError."""
    feed = _feed(payload)
    told_ns = _instant_ns(feed.header.timestamp)
    entities = [entity for entity in feed.entity if entity.HasField("vehicle")]
    reports = [_report(entity, told_ns) for entity in entities if not entity.is_deleted]
    placed = tuple(report for report in reports if report is not None)
    return Snapshot(told_ns, placed, len(reports) - len(placed))


def _feed(payload: bytes) -> realtime.FeedMessage:
    start = payload[:64].lstrip(b"\xef\xbb\xbf \t\r\n")
    if start.startswith(b"<"):
        raise NotRealtimeError("a web page, such as a login or an error")
    feed = realtime.FeedMessage()
    try:
        if start.startswith(b"{"):
            json_format.Parse(payload.decode("utf-8-sig"), feed, ignore_unknown_fields=True)
        else:
            feed.ParseFromString(payload)
    except (DecodeError, json_format.ParseError, UnicodeDecodeError):
        raise NotRealtimeError("neither GTFS-Realtime nor its JSON") from None
    if not feed.header.gtfs_realtime_version:
        raise NotRealtimeError("neither GTFS-Realtime nor its JSON" if payload else "nothing")
    return feed


def _instant_ns(timestamp_s: int) -> int | None:
    """0 is what is not told."""
    t_ns = timestamp_s * SECOND_NS
    return t_ns if EARLIEST_NS <= t_ns <= LATEST_NS else None


def _report(entity: realtime.FeedEntity, told_ns: int | None) -> VehicleReport | None:
    told = entity.vehicle
    t_ns = _instant_ns(told.timestamp) if told.timestamp else told_ns
    if t_ns is None or not told.HasField("position"):
        return None
    place = told.position
    if not (math.isfinite(place.latitude) and math.isfinite(place.longitude)):
        return None
    names = {
        "vehicle_id": told.vehicle.id,
        "label": told.vehicle.label,
        "license_plate": told.vehicle.license_plate,
        "trip_id": told.trip.trip_id,
        "route_id": told.trip.route_id,
    }
    return VehicleReport(
        told.vehicle.id or told.vehicle.label or entity.id,
        names,
        PositionReport(
            t_ns=t_ns,
            lat_deg=_degrees(place.latitude),
            lon_deg=_degrees(place.longitude),
            heading_deg=_degrees(place.bearing) if place.HasField("bearing") else None,
            speed_mps=place.speed if place.HasField("speed") else None,
            assignment=told.trip.trip_id or None,
        ),
    )


def _degrees(single: float) -> float:
    """Degrees travel as 32 bits; the digits beyond are not the sender's."""
    return float(str(np.float32(single)))
