"""Pure: one frame of a database, narrowed to what is mapped, and the quantities in it."""

from collections.abc import Callable, Iterable
from itertools import groupby
from typing import NamedTuple

from cantools.database.can import Message as DbcMessage
from cantools.database.can.signal import Signal
from cantools.database.errors import DecodeError

from wayline.messages import TOPICS, Message
from wayline_can_ingest.bits import BitReader, are_plain
from wayline_can_ingest.j1939 import not_available
from wayline_can_ingest.quantity import Extractor, Signals


class Output(NamedTuple):
    """A message of the bus that a frame makes, or (no topic) what others are computed with."""

    topic: type[Message] | None
    latency_ns: int
    extractors: tuple[Extractor, ...]


class FramePlan:
    """How one frame is decoded and which quantities come of it."""

    def __init__(self, message: DbcMessage, *, j1939: bool) -> None:
        self.name = message.name
        self.message = message
        self.extractors: list[Extractor] = []
        self.kept: set[str] = set()
        """Signals whose newest value conditions in other frames ask for."""
        self.outputs: tuple[Output, ...] = ()
        """What is not part of a fix, in the order in which it is to be read."""
        self.decode: Callable[[bytes], Signals] = self._decode
        """Decoded signals that the frame holds; empty for an unlisted multiplexer value."""
        self.fix_extractors: tuple[Extractor, ...] = ()
        self._j1939 = j1939
        self._narrowed = message
        self._raw_signals = {signal.name: signal for signal in message.signals} if j1939 else {}

    def compile(self) -> None:
        """Sort what is read, and leave out what nobody asks for; cantools reads what is not plain.

        It decodes a multiplexed frame whole, because what multiplexes has to be read anyway.
        """
        self.fix_extractors = tuple(each for each in self.extractors if each.topic == "gps_fix")
        rest = [each for each in self.extractors if each.topic not in ("gps_fix", "clock")]
        self.outputs = tuple(
            Output(TOPICS.get(topic), latency_ns, tuple(extractors))
            for (_, topic, latency_ns), extractors in groupby(sorted(rest, key=_order), _order)
        )
        if self.message.is_multiplexed():
            return
        needed = self.kept.union(*(each.own_signals() for each in self.extractors))
        signals = [signal for signal in self.message.signals if signal.name in needed]
        if are_plain(signals):
            self.decode = BitReader(signals, j1939=self._j1939).read
        else:
            self._narrowed = _narrowed(self.message, signals)

    def _decode(self, data: bytes) -> Signals:
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


def _order(extractor: Extractor) -> tuple[bool, str, int]:
    """What other quantities are computed with comes first."""
    return extractor.topic in TOPICS, extractor.topic, extractor.latency_ns


def _narrowed(message: DbcMessage, signals: list[Signal]) -> DbcMessage:
    """A message's frame with some of its signals only."""
    return DbcMessage(
        message.frame_id,
        message.name,
        message.length,
        signals,
        is_extended_frame=message.is_extended_frame,
        strict=False,
    )
