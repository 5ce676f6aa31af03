"""Pure: one gps_fix out of the several frames over which a receiver spreads it."""

from collections.abc import Iterator, Sequence

from wayline.messages import GpsFix, Message
from wayline_can_ingest.quantity import Extractor, Value

LONGEST_SPREAD_NS = 50_000_000
"""Frames of one epoch come within this time (SPEC section 3)."""


class SpreadFix:
    """Collects the fields of one epoch; it is complete when every mapped field has been seen."""

    def __init__(self, expected: frozenset[tuple[str, str]], latency_ns: int) -> None:
        self._expected = expected
        self._latency_ns = latency_ns
        self._seen: set[tuple[str, str]] = set()
        self._fields: dict[str, Value] = {}
        self._started_ns = 0
        self._t_ns = 0

    def take(
        self, frame: str, extractor: Extractor, value: Value | None, t_ns: int
    ) -> Iterator[Message]:
        """Add a field; if it begins a new epoch, give out the one before first."""
        part = (frame, extractor.field)
        if part in self._seen or (self._seen and t_ns - self._started_ns > LONGEST_SPREAD_NS):
            yield self._give_out()
        if not self._seen:
            self._started_ns = t_ns
            self._t_ns = t_ns - extractor.latency_ns
        self._seen.add(part)
        if value is not None:
            self._fields[extractor.field] = value

    def if_complete(self) -> Iterator[Message]:
        """Give out the epoch when nothing is missing."""
        if self._seen and self._seen == self._expected:
            yield self._give_out()

    def overdue(self, t_ns: int, *, at_end: bool = False) -> Sequence[Message]:
        """Give out an epoch that can no longer be completed."""
        if self._seen and (at_end or t_ns - self._started_ns > LONGEST_SPREAD_NS):
            return [self._give_out()]
        return ()

    def _give_out(self) -> GpsFix:
        fields = self._fields
        placed = "lat_deg" in fields and "lon_deg" in fields
        # 0 north 0 east is what receivers write for unknown
        placed = placed and not (fields["lat_deg"] == fields["lon_deg"] == 0.0)
        valid = placed and bool(fields.pop("valid", True))
        if not valid:
            fields.pop("lat_deg", None)
            fields.pop("lon_deg", None)
        fields.setdefault("mode", (3 if "alt_m" in fields else 2) if valid else 1)
        fields.setdefault("fix", "gps" if valid else "none")
        t_ns = max(self._t_ns - self._latency_ns, 0)
        fix = GpsFix(t_ns=t_ns, valid=valid, **fields)  # type: ignore[arg-type]
        self._seen, self._fields = set(), {}
        return fix
