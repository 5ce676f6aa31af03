"""Pure: receivers blinded for a while, to see how a vehicle is followed without them."""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from wayline.errors import InputError
from wayline.messages import GpsFix, GpsRaw, Message
from wayline.received import Received

HEAD_NS = 5_000_000_000
"""A drive's smallest t_ns comes within this much time of receipt of its first message."""


class Outage(NamedTuple):
    """GPS taken away, in seconds from the drive's smallest t_ns."""

    start_s: float
    length_s: float
    satellites: int = 0
    """So many stay in sight: too few for a fix, and only raw measurements tell of them."""


def parse_outage(text: str) -> Outage:
    """An outage from START_S:LENGTH_S. Raises InputError."""
    mend = "give START_S:LENGTH_S, e.g. 600:60"
    start, _, length = text.partition(":")
    try:
        outage = Outage(float(start), float(length))
    except ValueError:
        raise InputError("--gps-outage", f"{text!r} is no outage", mend) from None
    if not (outage.start_s >= 0.0 and outage.length_s > 0.0):
        raise InputError("--gps-outage", f"{text!r} is no outage", mend)
    return outage


def check_outages(messages: Iterable[Received], outages: Sequence[Outage]) -> None:
    """Raise InputError for an outage that begins behind a drive's end; reads up to the last one."""
    last = max(outages, key=lambda outage: outage.start_s)
    stream = iter(messages)
    head = _head(stream)
    start_ns = min((each.message.t_ns for each in head), default=0)
    lasted_s = 0.0
    for each in itertools.chain(head, stream):
        lasted_s = max(lasted_s, (each.message.t_ns - start_ns) * 1e-9)
        if lasted_s >= last.start_s:
            return
    text = f"{last.start_s:g}:{last.length_s:g}"
    what = f"{text} begins behind the drive's end, which is at {lasted_s:,.1f} s"
    raise InputError("--gps-outage", what, "give an earlier start")


def with_outages(messages: Iterable[Received], outages: Sequence[Outage]) -> Iterator[Received]:
    """Blank what receivers measured during an outage: fixes, and satellites before any fix."""
    stream = iter(messages)
    head = _head(stream)
    if not head:
        return
    start_ns = min(received.message.t_ns for received in head)
    spans = [
        (start_ns + round(start_s * 1e9), start_ns + round((start_s + length_s) * 1e9), satellites)
        for start_s, length_s, satellites in outages
    ]
    for received in itertools.chain(head, stream):
        message = received.message
        left = next((left for a, b, left in spans if a <= message.t_ns < b), None)
        yield received if left is None else received._replace(message=blanked(message, left))


def blanked(message: Message, satellites: int = 0) -> Message:
    """What a receiver says that sees so few satellites; of other sensors the message itself.

    Those left are the first by system and number, wherever they stand in the sky.
    """
    if isinstance(message, GpsFix):
        return GpsFix(t_ns=message.t_ns, valid=False, satellites=0)
    if isinstance(message, GpsRaw):
        seen = sorted(message.satellites, key=lambda each: (each.system != "gps", each.prn))
        return GpsRaw(t_ns=message.t_ns, satellites=tuple(seen[:satellites]))
    return message


def _head(stream: Iterator[Received]) -> list[Received]:
    head: list[Received] = []
    for received in stream:
        head.append(received)
        if received.received_ns - head[0].received_ns > HEAD_NS:
            break
    return head
