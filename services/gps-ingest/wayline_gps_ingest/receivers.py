"""Live receivers as feeds. Each comes back by itself, however its link or device went."""

import threading
import time
from collections.abc import Callable, Mapping
from typing import ClassVar

import msgspec

from wayline.live_sources import LiveNmea, LiveRaw
from wayline.messages import GpsFix, GpsRaw, Message
from wayline.view import Receipt
from wayline_gps_ingest.condition import Condition
from wayline_gps_ingest.links import NMEA, Link, Speech, address_of

RETRY_S = (0.1, 0.2, 0.5)
"""Between attempts to connect. The last goes on: soon enough for fixes within 2 s of a return,
when the receiver itself takes one of them."""
NOT_TRIED = "not tried yet"


class Receiver:
    """One receiver as a feed of lines, or of messages in a protocol of its own."""

    can_wait = False

    def __init__(self, name: str, source: LiveNmea | LiveRaw, speech: Speech = NMEA) -> None:
        self.name = name
        self._url = source.url
        self.is_gpsd = source.url.startswith("gpsd:")
        self._address = address_of(source, speech)
        self._link: Link | None = None
        self._error = NOT_TRIED
        self._connections = 0
        self._byte_s: float | None = None
        self._sentence_s: float | None = None
        self._fix_s: float | None = None
        self.faults: Callable[[], Mapping[str, int]] = dict
        """What its core has counted and dropped, by reason."""

    def fixed(self) -> None:
        """Take note of a valid fix, or of satellites measured, that it has told."""
        self._fix_s = time.monotonic()

    @property
    def condition(self) -> Condition:
        """How the receiver does now."""
        link = self._link
        now_s = time.monotonic()

        def age_s(then_s: float | None) -> float | None:
            return None if then_s is None else max(now_s - then_s, 0.0)

        return Condition(
            url=self._url,
            link_error=self._error if link is None else None,
            note=None if link is None else link.note,
            byte_age_s=age_s(self._byte_s),
            sentence_age_s=age_s(self._sentence_s),
            fix_age_s=age_s(self._fix_s),
            reconnections=max(self._connections - 1, 0),
            faults=self.faults(),
        )

    @property
    def detail(self) -> str:
        """How the receiver does, for `health`."""
        return self.condition.text

    @property
    def problem(self) -> str | None:
        """Why nothing is heard of the receiver; in a tunnel it is there all the same."""
        absence = self.condition.absence
        return None if absence is None else f"{self._url}: {absence}"

    def run(self, put: Callable[[msgspec.Struct], None], stop: threading.Event) -> None:
        """Read until told to stop; connect again whenever the link ends or falls silent."""
        failures = 0
        while not stop.is_set():
            try:
                with self._address.open() as link:
                    self._link = link
                    self._connections += 1
                    if self._read(link, put, stop):
                        failures = 0
            except OSError as error:
                self._error = error.strerror or str(error)
            finally:
                self._link = None
            stop.wait(RETRY_S[min(failures, len(RETRY_S) - 1)])
            failures += 1

    def _read(
        self, link: Link, put: Callable[[msgspec.Struct], None], stop: threading.Event
    ) -> bool:
        """Whether anything was heard before the link fell silent. Raises OSError at its end."""
        opened_s = last_s = time.monotonic()
        while not stop.is_set() and time.monotonic() - last_s < link.patience_s:
            heard = link.read()
            if not heard.size_bytes:
                continue
            self._byte_s = last_s = time.monotonic()
            received_ns = time.time_ns()
            for line in heard.lines:
                self._sentence_s = last_s
                put(self._address.line(received_ns, line))
        self._error = "silent"
        return last_s > opened_s


class FixNotes:
    """A view of what is published: tells each receiver of the fixes made of its sentences."""

    reads: ClassVar[frozenset[type[Message]]] = frozenset()

    def __init__(self, receivers: Mapping[str, Receiver]) -> None:
        self._receivers = receivers

    def put(self, vehicle_id: str, message: Message, source: str, receipt: Receipt) -> None:
        """Take a published message; valid fixes count, and epochs with satellites."""
        del vehicle_id, receipt
        is_fix = isinstance(message, GpsFix) and message.valid
        is_measured = isinstance(message, GpsRaw) and bool(message.satellites)
        if (is_fix or is_measured) and source in self._receivers:
            self._receivers[source].fixed()

    def forget(self, vehicle_id: str) -> None:
        """Nothing is kept of a vehicle."""
