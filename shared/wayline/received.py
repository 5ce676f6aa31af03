"""Pure: a recording's messages with the time at which each reached the bus."""

import heapq
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple, TypeVar

import msgspec

from wayline.errors import InputError, UnreadableError
from wayline.inputs import Flush
from wayline.messages import Message


class Received(NamedTuple):
    """A message as it reaches the bus."""

    received_ns: int
    order: int
    """Of its source among the drive's sources: nmea, avl, raw, can; settles ties."""
    source: str
    message: Message


class Account(msgspec.Struct, frozen=True):
    """What became of a source's input so far, besides the messages."""

    left_out: Mapping[str, int] = {}
    """Left out on purpose, by reason."""
    warnings: Sequence[str] = ()
    """What a user should know though the rest was read; one line each."""


def _unexplained() -> InputError:
    return InputError("drive", "nothing of it could be read", "check the files that it names")


class Recording(NamedTuple):
    """One source of a drive: its name on the bus, its messages, and what was dropped so far."""

    source: str
    messages: Iterable[tuple[int, Message]]
    """Each with its receipt, Unix ns. Raises UnreadableError where the source cannot be read."""
    bad_input: Callable[[], int]
    account: Callable[[], Account] = Account
    nothing: Callable[[], InputError] = _unexplained
    """Why no message came of the source; asked once it has ended without one."""


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


class InOrder:
    """Messages of one source, received never earlier than the one before; ends where it breaks."""

    def __init__(self, order: int, recording: Recording) -> None:
        self._order = order
        self.recording = recording
        self._count = 0
        self._broken: UnreadableError | None = None
        self.nothing: InputError | None = None
        """Why nothing came of the source; None where something did, and until it has ended."""

    def __iter__(self) -> Iterator[Received]:
        latest_ns = 0
        try:
            for received_ns, message in self.recording.messages:
                latest_ns = max(latest_ns, received_ns)
                self._count += 1
                yield Received(latest_ns, self._order, self.recording.source, message)
        except UnreadableError as error:
            self._broken = error
        if not self._count:
            self.nothing = self._broken or self.recording.nothing()

    @property
    def warnings(self) -> list[str]:
        """What a user should know of the source, once it has ended."""
        errors = [error for error in (self._broken, self.nothing) if error is not None]
        return list(dict.fromkeys([*self.recording.account().warnings, *map(str, errors)]))


class Sources:
    """The sources of a drive in order of receipt; iterates once."""

    def __init__(self, recordings: Iterable[Recording]) -> None:
        self._sources = [InOrder(order, each) for order, each in enumerate(recordings)]

    def __iter__(self) -> Iterator[Received]:
        return heapq.merge(*self._sources, key=lambda received: received[:2])

    def check(self) -> None:
        """Once all have ended: raises the first one's InputError where nothing came of any."""
        reasons = [each.nothing for each in self._sources]
        if reasons and reasons[0] is not None and None not in reasons:
            raise reasons[0]

    @property
    def warnings(self) -> list[str]:
        """Once all have ended: of which nothing came, and what else a user should know."""
        return [warning for each in self._sources for warning in each.warnings]

    @property
    def bad_input(self) -> dict[str, int]:
        """Sentences, rows and frames that were counted and dropped so far, by source."""
        return {each.recording.source: each.recording.bad_input() for each in self._sources}

    @property
    def left_out(self) -> dict[str, Mapping[str, int]]:
        """What was left out on purpose so far, by source and reason."""
        return {each.recording.source: each.recording.account().left_out for each in self._sources}


def begun(recordings: Iterable[Recording]) -> Sources:
    """The sources, each read up to its first message. Raises InputError where there is none.

    Freshly opened recordings only: what is read of them is gone.
    """
    recordings = list(recordings)
    sources = Sources(
        each._replace(messages=itertools.islice(each.messages, 1)) for each in recordings
    )
    for _ in sources:
        pass
    sources.check()
    return sources


def source_names(service: str) -> Iterator[str]:
    """`gps-ingest`, `gps-ingest-2`, ..."""
    yield service
    for number in itertools.count(2):
        yield f"{service}-{number}"
