"""A receiver for tests: sentences with right checksums, and a core that hears them."""

from collections.abc import Iterable
from functools import reduce
from operator import xor
from pathlib import Path

from wayline.inputs import Flush, Sentence
from wayline.messages import GpsFix, Message
from wayline.nmea_log import read_sentences
from wayline_gps_ingest.core import GpsIngestCore

POSITION = "4807.038,N,01131.000,E"
LAT_DEG, LON_DEG = 48.1173, 11.0 + 31.0 / 60.0


def line(body: str) -> str:
    """A sentence from what stands between `$` and `*`."""
    return f"${body}*{reduce(xor, body.encode()):02X}"


def gga(time: str, quality: int = 1, position: str = POSITION) -> str:
    return line(f"GPGGA,{time},{position},{quality},08,0.9,545.4,M,46.9,M,,")


def rmc(time: str, status: str = "A", date: str = "230394", position: str = POSITION) -> str:
    return line(f"GPRMC,{time},{status},{position},022.4,084.4,{date},003.1,W")


def gsa(mode: int = 3) -> str:
    return line(f"GPGSA,A,{mode},04,05,,09,12,,,24,,,,,2.5,1.3,2.1")


def hear(
    core: GpsIngestCore, texts: Iterable[str], received_ns: int | None = None
) -> list[Message]:
    """What a core makes of sentences, one at a time."""
    return [
        message for text in texts for message in core.handle(Sentence(received_ns, text), "test")
    ]


def flush(core: GpsIngestCore) -> list[Message]:
    return core.handle(Flush(0), "test")


def replay(path: Path) -> tuple[GpsIngestCore, list[Message]]:
    """A whole log through a core of its own."""
    core = GpsIngestCore()
    messages = [
        message for sentence in read_sentences(path) for message in core.handle(sentence, "test")
    ]
    return core, messages + flush(core)


def fixes(messages: Iterable[Message]) -> list[GpsFix]:
    return [message for message in messages if isinstance(message, GpsFix)]
