"""Pure: tells of what is left out of a track by the places where it begins and ends."""

from bisect import bisect_left
from collections.abc import Iterable
from typing import NamedTuple

from wayline_slope_map.left_out import LEAPT, LeftOut, Span
from wayline_slope_map.track import Place, Track

NEAR_M = 50.0
"""Travelled; a place that is farther away is not where something began or ended."""


class _Point(NamedTuple):
    lat_deg: float | None = None
    lon_deg: float | None = None


def told(vehicle_id: str, track: Track, spans: Iterable[Span]) -> list[LeftOut]:
    """Spans of a track as they are told."""
    return [_told(vehicle_id, track.places, span) for span in spans]


def leapt(vehicle_id: str, last: Place, place: Place) -> LeftOut:
    """A leap from one place to another."""
    span = Span(None, LEAPT, last.t_ns, place.t_ns, last.travelled_m, place.travelled_m)
    return _told(vehicle_id, [last, place], span)


def whole(track: Track, reason: str) -> list[Span]:
    """All of a track; nothing where it is too short to be told of."""
    if not track.times_ns:
        return []
    ends = track.times_ns[0], track.times_ns[-1], track.travelled_m[0], track.travelled_m[-1]
    span = Span(None, reason, *ends)
    return [span] if span.is_told else []


def _told(vehicle_id: str, places: list[Place], span: Span) -> LeftOut:
    start, end = _nearest(places, span.from_m), _nearest(places, span.to_m)
    return LeftOut(
        vehicle_id=vehicle_id,
        sensor=span.sensor,
        reason=span.reason,
        start_ns=span.start_ns,
        end_ns=span.end_ns,
        length_m=span.to_m - span.from_m,
        start_lat_deg=start.lat_deg,
        start_lon_deg=start.lon_deg,
        end_lat_deg=end.lat_deg,
        end_lon_deg=end.lon_deg,
    )


def _nearest(places: list[Place], travelled_m: float) -> _Point:
    at = bisect_left(places, travelled_m, key=lambda place: place.travelled_m)
    near = min(
        places[max(at - 1, 0) : at + 1],
        key=lambda place: abs(place.travelled_m - travelled_m),
        default=None,
    )
    if near is None or abs(near.travelled_m - travelled_m) > NEAR_M:
        return _Point()
    return _Point(near.lat_deg, near.lon_deg)
