"""Pure: a recording's messages with the time at which each reached the bus."""

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple, TypeVar

import msgspec

from wayline.inputs import Flush
from wayline.messages import Message


class Received(NamedTuple):
    """A message as it reaches the bus."""

    received_ns: int
    order: int
    """Of its source among the drive's sources: nmea, avl, can; settles ties."""
    source: str
    message: Message


class Recording(NamedTuple):
    """One source of a drive: its name on the bus, its messages, and what was dropped so far."""

    source: str
    messages: Iterable[tuple[int, Message]]
    """Each with its receipt, Unix ns."""
    bad_input: Callable[[], int]


Raw = TypeVar("Raw", bound=msgspec.Struct)


def translated(
    inputs: Iterable[Raw],
    handle: Callable[[msgspec.Struct, str], Sequence[Message]],
    source: str,
    received_ns: Callable[[Raw, Message], int],
) -> Iterator[tuple[int, Message]]:
    """Messages that an ingest core makes of raw input, with their receipt."""
    last: Raw | None = None
    for last in inputs:
        for message in handle(last, source):
            yield received_ns(last, message), message
    if last is not None:
        for message in handle(Flush(0), source):
            yield received_ns(last, message), message


def in_order(order: int, recording: Recording) -> Iterator[Received]:
    """Messages of one source, received never earlier than the one before."""
    latest_ns = 0
    for received_ns, message in recording.messages:
        latest_ns = max(latest_ns, received_ns)
        yield Received(latest_ns, order, recording.source, message)


def source_names(service: str) -> Iterator[str]:
    """Names on the bus of a service's sources: `gps-ingest`, `gps-ingest-2`, ..."""
    yield service
    for number in itertools.count(2):
        yield f"{service}-{number}"
