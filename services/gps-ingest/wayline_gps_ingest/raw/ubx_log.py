"""Reads a u-blox receiver's log: UBX messages among whatever else it sent."""

import io
from collections.abc import Iterator, Mapping
from pathlib import Path

from wayline.errors import InputError
from wayline.log_file import LogFile
from wayline_gps_ingest.raw.ephemerides import Placing
from wayline_gps_ingest.raw.epoch import RawEpoch
from wayline_gps_ingest.raw.ubx import HearsMessages, UbxReceiver

CHUNK_BYTES = 1 << 16


class UbxLog:
    """A log, read once, packed or not, as epochs with their satellites' places."""

    def __init__(self, path: Path, placing: Placing, heard: HearsMessages | None) -> None:
        self._path = path
        self._receiver = UbxReceiver(placing, heard)
        self._is_broken = False

    @property
    def faults(self) -> Mapping[str, int]:
        """What was counted and dropped or mended so far, by reason (`UbxReceiver.faults`).

        `broken`: a packed log that could not be unpacked to its end.
        """
        return self._receiver.faults | ({"broken": 1} if self._is_broken else {})

    def __iter__(self) -> Iterator[RawEpoch]:
        try:
            with LogFile(self._path) as log, io.BufferedReader(log, CHUNK_BYTES) as file:
                while chunk := file.read(CHUNK_BYTES):
                    yield from self._receiver.feed(chunk)
                yield from self._receiver.end()
                self._is_broken = log.is_broken
        except OSError as error:
            what = f"cannot be read ({error.strerror or error})"
            raise InputError(str(self._path), what, "check the file") from None

    def nothing(self) -> InputError:
        """Why it holds no epoch."""
        mend = "let the receiver send RXM-RAWX (and RXM-SFRBX)"
        seen = f"{self._receiver.messages:,} UBX messages, none of them a whole RXM-RAWX"
        return InputError(str(self._path), f"holds {seen}", mend)
