"""Pure: one frame of a database, narrowed to what is mapped, and the quantities in it."""

from collections.abc import Iterable

from cantools.database.can import Message as DbcMessage
from cantools.database.errors import DecodeError

from wayline_can_ingest.j1939 import not_available
from wayline_can_ingest.quantity import Extractor, Signals


class FramePlan:
    """How one frame is decoded and which quantities come of it."""

    def __init__(self, message: DbcMessage, *, j1939: bool) -> None:
        self.name = message.name
        self.message = message
        self.extractors: list[Extractor] = []
        self.kept: set[str] = set()
        """Signals whose newest value conditions in other frames ask for."""
        self._narrowed = message
        self._raw_signals = {signal.name: signal for signal in message.signals} if j1939 else {}

    def compile(self) -> None:
        """Leave out signals that nobody asks for; a multiplexed frame is decoded whole.

        What other quantities are computed with goes first.
        """
        self.extractors.sort(key=lambda each: (each.topic != "vehicle", each.field))
        message = self.message
        if message.is_multiplexed():
            return
        needed = self.kept.union(*(each.own_signals() for each in self.extractors))
        self._narrowed = DbcMessage(
            message.frame_id,
            message.name,
            message.length,
            [signal for signal in message.signals if signal.name in needed],
            is_extended_frame=message.is_extended_frame,
            strict=False,
        )

    def decode(self, data: bytes) -> Signals:
        """Decoded signals that the frame holds; empty for an unlisted multiplexer value."""
        try:
            values = self._narrowed.decode_simple(
                data,
                decode_choices=False,
                scaling=not self._raw_signals,
                allow_truncated=True,
            )
        except DecodeError:
            return {}
        if not self._raw_signals:
            return values  # type: ignore[return-value]
        return dict(self._available(values))  # type: ignore[arg-type]

    def _available(self, values: dict[str, float]) -> Iterable[tuple[str, float | None]]:
        for name, raw in values.items():
            signal = self._raw_signals[name]
            known = signal.conversion.is_float or not not_available(raw, signal.length)
            yield name, signal.conversion.raw_to_scaled(raw, False) if known else None  # type: ignore[misc]
