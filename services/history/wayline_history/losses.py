"""What could not be kept, so that the history says where it has gaps."""

import threading

from wayline.spool import Waiting
from wayline_history.records import Event, Piece


class Losses:
    """Pieces that were pushed out while the database was away, or that it refused.

    One thread notes, another takes.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._spans: dict[str, tuple[int, int, int]] = {}
        """First and last instant, pieces; by vehicle."""

    def note(self, waiting: Waiting) -> None:
        """A record is lost."""
        span = waiting.record.span_ns() if isinstance(waiting.record, Piece) else None
        if span is None:
            return
        with self._lock:
            first, last, pieces = self._spans.get(waiting.vehicle_id, (*span, 0))
            self._spans[waiting.vehicle_id] = min(first, span[0]), max(last, span[1]), pieces + 1

    def take(self) -> list[tuple[str, Piece]]:
        """A gap for each vehicle that lost something since the last time, to be kept."""
        with self._lock:
            spans, self._spans = self._spans, {}
        return [(vehicle, Piece(events=(_gap(*span),))) for vehicle, span in spans.items()]

    def put_back(self, gaps: list[tuple[str, Piece]]) -> None:
        """They could not be kept either: tell them later."""
        for vehicle_id, piece in gaps:
            (event,) = piece.events
            span = event.t_ns, event.until_ns or event.t_ns, event.count or 0
            with self._lock:
                first, last, pieces = self._spans.get(vehicle_id, (span[0], span[1], 0))
                whole = min(first, span[0]), max(last, span[1]), pieces + span[2]
                self._spans[vehicle_id] = whole


def _gap(first_ns: int, last_ns: int, pieces: int) -> Event:
    return Event(
        t_ns=first_ns,
        until_ns=last_ns,
        kind="gap",
        name="lost",
        count=pieces,
        detail="the database was away or full, and more came than could wait for it",
    )
