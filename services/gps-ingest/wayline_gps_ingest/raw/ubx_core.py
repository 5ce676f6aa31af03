"""Pure: a u-blox receiver's messages in, `gps_raw` out."""

from typing import ClassVar

import msgspec

from wayline.inputs import Flush
from wayline.messages import Message
from wayline_gps_ingest.raw.core import RawIngestCore
from wayline_gps_ingest.raw.ubx import UbxReceiver
from wayline_gps_ingest.raw.ubx_frames import UbxBytes


class UbxCore:
    """One receiver: its messages decoded by `UbxReceiver`, its epochs told by `RawIngestCore`."""

    reads: ClassVar[frozenset[type[Message]]] = frozenset()
    period_ns: ClassVar[int | None] = None

    def __init__(self, receiver: UbxReceiver, epochs: RawIngestCore) -> None:
        self._receiver = receiver
        self._epochs = epochs

    @property
    def faults(self) -> dict[str, int]:
        """Bad input so far, by reason, as the two of them name it."""
        return self._receiver.faults | self._epochs.faults

    def handle(self, message: msgspec.Struct, source: str) -> list[Message]:
        """Take UbxBytes or Flush; return what it completes."""
        if isinstance(message, Flush):
            return self._epochs.handle(message, source)
        if not isinstance(message, UbxBytes):
            return []
        epochs = self._receiver.take([message.message], message.received_ns)
        return [told for epoch in epochs for told in self._epochs.handle(epoch, source)]
