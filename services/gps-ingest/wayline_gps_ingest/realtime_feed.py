"""An agency's GTFS-Realtime feed, asked for every few seconds, as a feed of vehicles' reports."""

import contextlib
import threading
import time
from collections import Counter
from collections.abc import Mapping
from urllib.parse import urlsplit

import msgspec

from wayline.live_sources import LiveAvl
from wayline.service import Put
from wayline_gps_ingest.agency import Agency
from wayline_gps_ingest.realtime_client import FeedError, RealtimeClient
from wayline_gps_ingest.vehicle_positions import NotRealtimeError, read_vehicle_positions

PAUSE_MAX_S = 300.0
"""The longest pause between two tries of a feed that fails, if it asks for none."""
STANDS_STILL_LOOKS = 3.0
STANDS_STILL_MIN_S = 90.0
"""A feed that says nothing new for so many looks, and so long, is down behind its address."""


class RealtimeFeed:
    """The vehicles of one agency. Comes back by itself, asks less often while it is refused."""

    can_wait = False

    def __init__(self, name: str, source: LiveAvl, key: str | None) -> None:
        self.name = name
        self._every_s = source.every_s
        self._client = RealtimeClient(source, key)
        self._shown = urlsplit(source.url).hostname
        self._agency = Agency()
        self._faults: Counter[str] = Counter()
        self._error: str | None = "not asked yet"
        self._vehicles = 0
        self._new_s = time.monotonic()

    def faults(self) -> Mapping[str, int]:
        """What was counted and dropped, by reason."""
        return {**self._agency.faults, **self._faults}

    @property
    def detail(self) -> str:
        """How the feed does, for `health`."""
        if self._error is not None:
            return f"{self._shown}: {self._error}"
        faults = "".join(f", {times:,} {why}" for why, times in sorted(self.faults().items()))
        return f"{self._shown}: {self._vehicles:,} vehicles{faults}"

    @property
    def problem(self) -> str | None:
        """Why nothing new comes from it."""
        if self._error is not None:
            return f"{self._shown}: {self._error}"
        silent_s = time.monotonic() - self._new_s
        if silent_s > max(STANDS_STILL_MIN_S, STANDS_STILL_LOOKS * self._every_s):
            return f"{self._shown}: nothing new for {silent_s:.0f} s"
        return None

    def run(self, put: Put, stop: threading.Event) -> None:
        """Ask until told to stop."""
        failures = 0
        with contextlib.closing(self._client):
            while not stop.is_set():
                started_s, least_s = time.monotonic(), self._every_s
                try:
                    self._look(put)
                    failures, self._error = 0, None
                except FeedError as error:
                    failures, self._error = failures + 1, str(error)
                    least_s = max(least_s, error.retry_after_s)
                pause_s = max(min(self._every_s * 2.0**failures, PAUSE_MAX_S), least_s)
                stop.wait(max(started_s + pause_s - time.monotonic(), 0.0))

    def _look(self, put: Put) -> None:
        """Ask once, and put what is new. Raises FeedError."""
        payload = self._client.fetched()
        if payload is None:
            return
        try:
            snapshot = read_vehicle_positions(payload)
        except NotRealtimeError as error:
            self._faults["unreadable"] += 1
            raise FeedError(f"answers with {error}") from None
        before_ns, received_ns = self._agency.told_ns, time.time_ns()
        for vehicle_id, report in self._agency.take(snapshot, received_ns):
            put(msgspec.structs.replace(report, received_ns=received_ns), vehicle_id)
        if self._agency.told_ns != before_ns:
            self._new_s, self._vehicles = time.monotonic(), len(snapshot.vehicles)
