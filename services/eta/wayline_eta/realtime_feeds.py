"""GTFS-Realtime feeds as bytes, made once a second, however many ask.

A reader may conclude from an unchanged header that nothing has changed, so one second has one
content.
"""

import threading
from collections.abc import Callable
from typing import Annotated, Literal

import msgspec
from google.protobuf import json_format
from msgspec import Meta

from wayline.host_clock import told_ns
from wayline.view import Clock
from wayline_eta.board import EtaBoard
from wayline_eta.gtfs_realtime import SECOND_NS, Feed, trip_updates, vehicle_positions

Format = Literal["protobuf", "json"]
MEDIA_TYPES = {"protobuf": "application/x-protobuf", "json": "application/json"}


class FeedParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What a question for a feed may say."""

    format: Annotated[Format, Meta(description="json is the protobuf's JSON mapping")] = "protobuf"


class RealtimeFeed:
    """One of the feeds; threads may ask at once."""

    def __init__(self, make: Callable[[int], Feed], clock_ns: Clock = told_ns) -> None:
        """`make` makes it at a Unix time in seconds."""
        self._make, self._clock_ns = make, clock_ns
        self._lock = threading.Lock()
        self._second, self._feed = -1, Feed()
        self._rendered: dict[Format, bytes] = {}

    def bytes_of(self, form: Format) -> bytes:
        """The feed of this second; the host's clock never goes back in it."""
        with self._lock:
            second = max(self._clock_ns() // SECOND_NS, self._second)
            if second != self._second:
                self._second, self._feed, self._rendered = second, self._make(second), {}
            if form not in self._rendered:
                self._rendered[form] = _encoded(self._feed, form)
            return self._rendered[form]


def positions_feed(board: EtaBoard, clock_ns: Clock = told_ns) -> RealtimeFeed:
    """Where all vehicles of a board are."""

    def make(unix_s: int) -> Feed:
        vehicles, now_ns = board.look_at_all()
        return vehicle_positions(vehicles, now_ns, unix_s)

    return RealtimeFeed(make, clock_ns)


def updates_feed(board: EtaBoard, clock_ns: Clock = told_ns) -> RealtimeFeed:
    """When all vehicles of a board come to their stops."""
    return RealtimeFeed(lambda unix_s: trip_updates(board.look_at_all()[0], unix_s), clock_ns)


def _encoded(feed: Feed, form: Format) -> bytes:
    if form == "protobuf":
        return feed.SerializeToString()
    return json_format.MessageToJson(feed, preserving_proto_field_name=True).encode()
