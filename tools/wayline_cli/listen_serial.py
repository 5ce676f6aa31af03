"""Listens to a serial line for a few seconds, as gps-ingest would, and tells what it says."""

import threading
import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import msgspec

from wayline.inputs import Sentence
from wayline.live_sources import LiveNmea, LiveRaw
from wayline.messages import GpsFix
from wayline_gps_ingest.baud import is_sound
from wayline_gps_ingest.condition import Condition
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.links import NMEA, UBX_ONLY, ubx_speech
from wayline_gps_ingest.raw.ubx_frames import RAWX, SFRBX, UbxBytes
from wayline_gps_ingest.receivers import NOT_TRIED, Receiver

LISTEN_S = 3.0
"""After the first sentence: two epochs of a receiver that speaks once a second."""
SEARCH_S = 10.0
"""A round through all baud rates of a receiver that speaks once a second."""
SILENT_S = 3.0
"""A line on which nothing at all comes for so long is silent."""
REFUSED_S = 0.5
"""A line that cannot be opened for so long cannot be had."""
POLL_S = 0.05
UBX_NAMES = {RAWX: "RXM-RAWX", SFRBX: "RXM-SFRBX"}
OTHER_UBX = "other UBX"


class Hearing(NamedTuple):
    """What a line said."""

    problem: str | None
    """Of the line: it is in use, not there, silent; None where sentences came."""
    note: str | None = None
    """The rate as found."""
    sentences: tuple[str, ...] = ()
    """Talker and kind of the sound ones, e.g. GPRMC; of a raw source its messages' names."""
    has_fix: bool = False
    """A valid fix is among it, of a raw source an epoch of measurements."""


class Listening:
    """The sentences or UBX messages of a receiver so far."""

    def __init__(self) -> None:
        self.lines: list[Sentence] = []
        self.messages: list[UbxBytes] = []
        self.first_s: float | None = None

    def put(self, message: msgspec.Struct) -> None:
        """Take a UBX message, or a sentence, if it is one: a wrong rate makes noise."""
        if isinstance(message, Sentence) and is_sound(message.text):
            self.lines.append(message)
        elif isinstance(message, UbxBytes):
            self.messages.append(message)
        else:
            return
        self.first_s = self.first_s or time.monotonic()

    @property
    def kinds(self) -> tuple[str, ...]:
        """What was heard, each kind once."""
        names = {UBX_NAMES.get(each.message[2:4], OTHER_UBX) for each in self.messages}
        return (*kinds_of(self.lines), *sorted(names))


def listen(receiver: LiveNmea | LiveRaw) -> Hearing:
    """What a serial line says within seconds; one that another program has open is left alone."""
    device = receiver.url.removeprefix("serial://").partition("?")[0]
    if holder := holder_of(device):
        return Hearing(f"in use by {holder}")
    speech = ubx_speech(Counter()) if isinstance(receiver, LiveRaw) else NMEA
    feed, heard, stop = Receiver("doctor", receiver, speech), Listening(), threading.Event()
    reader = threading.Thread(target=feed.run, args=(heard.put, stop))
    reader.start()
    try:
        await_enough(feed, heard)
        condition = feed.condition
    finally:
        stop.set()
        reader.join()
    if heard.first_s is None:
        problem = condition.link_error or condition.problem or "sends nothing readable"
        return Hearing(problem, condition.note)
    has_fix = UBX_NAMES[RAWX] in heard.kinds or fix_in(heard.lines)
    return Hearing(None, condition.note, heard.kinds, has_fix)


def await_enough(feed: Receiver, heard: Listening) -> None:
    """Wait until enough was heard, or nothing can be expected any more."""
    started_s = time.monotonic()
    while (waited_s := time.monotonic() - started_s) < SEARCH_S:
        condition = feed.condition
        if heard.first_s is not None and time.monotonic() - heard.first_s >= LISTEN_S:
            return
        if waited_s >= REFUSED_S and condition.link_error not in {None, NOT_TRIED}:
            return
        if waited_s >= SILENT_S and (condition.byte_age_s is None or is_ubx(condition)):
            return
        time.sleep(POLL_S)


def is_ubx(condition: Condition) -> bool:
    """Whether the receiver is there but speaks another language."""
    return UBX_ONLY in (condition.note or "")


def kinds_of(lines: list[Sentence]) -> tuple[str, ...]:
    """Talkers and kinds, each once."""
    return tuple(sorted({line.text[1:].partition(",")[0] for line in lines}))


def fix_in(lines: list[Sentence]) -> bool:
    """Whether a valid fix can be made of sentences."""
    core = GpsIngestCore()
    messages = [message for line in lines for message in core.handle(line, "doctor")]
    return any(isinstance(message, GpsFix) and message.valid for message in messages)


def holder_of(device: str) -> str | None:
    """The program that has a device open, as far as this user may see; opening would disturb it."""
    target = Path(device).resolve()
    for opened in Path("/proc").glob("[0-9]*/fd/*"):
        try:
            if opened.readlink() == target:
                process = opened.parents[1]
                name = (process / "comm").read_text().strip()
                return f"{name} (process {process.name})"
        except OSError:
            # it ended meanwhile, or is another user's
            continue
    return None
