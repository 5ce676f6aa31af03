"""What a service is made of: cores that decide, views that show, feeds that bring raw input."""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import msgspec

from wayline.http import Healthz
from wayline.inbox import Sample
from wayline.messages import TOPICS, Health, Message
from wayline.node import Node
from wayline.queryable import Answer
from wayline.seats import MakeNode
from wayline.telemetry import Telemetry
from wayline.view import View


class Put(Protocol):
    """Takes an input; of the machine's own vehicle, where none is named."""

    def __call__(self, message: msgspec.Struct, vehicle_id: str | None = None) -> None:
        """Hand it to its core."""
        ...


class Feed(Protocol):
    """A source of raw input: a receiver, an interface, a recording. Runs in a thread of its own."""

    name: str
    """Becomes the `source` of what it gives."""
    can_wait: bool
    """A recording waits for room in the inbox; what a live source says without room is dropped."""

    def run(self, put: Put, stop: threading.Event) -> None:
        """Put inputs until told to stop; come back by itself when the device does."""
        ...

    @property
    def detail(self) -> str | None:
        """What `health` should say of it."""
        ...

    @property
    def problem(self) -> str | None:
        """Why nothing comes from it; None where something does."""
        ...


class Storage(Protocol):
    """Keeps what the cores want kept, in a thread of its own (`wayline.patient_store`)."""

    def start(self, failed: Callable[[], None]) -> None:
        """Begin; `failed` is called, in that thread, when it ends."""
        ...

    def hand_over(self) -> None:
        """Tell, in the caller's thread, what has been learned from the database."""
        ...

    def close(self) -> None:
        """Keep what waits, as far as that is quick. Raises what ended the thread, if it did."""
        ...

    @property
    def problem(self) -> str | None:
        """Why nothing is kept now; None where all is well."""
        ...

    @property
    def detail(self) -> str | None:
        """What `health` should say of it: the problem, or what it has cost."""
        ...


def no_core(vehicle_id: str, source: str) -> Node:
    """For a service without cores: it shows, or its feeds give ready messages."""
    raise AssertionError(f"there is no core for input of {vehicle_id} from {source}")


@dataclass(slots=True)
class Service:
    """What a shell hands over."""

    name: str
    make_node: MakeNode = no_core
    core_reads: frozenset[type[Message]] = frozenset()
    """Topics that go to the cores."""
    views: Sequence[View] = ()
    """Told every message heard and published."""
    watch_alive: Callable[[str, str, bool], None] | None = None
    """Told of services that come and go, with their vehicle."""
    take_sample: Callable[[Sample], None] | None = None
    """Gets every sample of every topic as it was on the bus, before and beside all else."""
    make_app: Callable[[Callable[[], Healthz], Telemetry], Any] | None = None
    answers: Mapping[str, Answer] = field(default_factory=dict)
    """By the key of the queryable."""
    feeds: Sequence[Feed] = ()
    store: Storage | None = None
    bad_input: Callable[[], int] = lambda: 0
    """What the cores and feeds have counted and dropped."""
    notice: Callable[[], str | None] = lambda: None
    """What else `health` should say now."""
    is_recorded: bool = False
    """The feeds play a recording."""
    is_announced: bool = True
    """Others are told that it is there: a liveliness token, `health`."""

    @property
    def reads(self) -> frozenset[type[Message]]:
        """Topics that are decoded: what the cores and the views want."""
        return self.core_reads.union(*(view.reads for view in self.views))

    @property
    def inputs(self) -> frozenset[type[Message]]:
        """Topics without which it has nothing to do: its cores', else its views'; not `health`."""
        return (self.core_reads or (frozenset() if self.feeds else self.reads)) - {Health}

    @property
    def topics(self) -> frozenset[str]:
        """Topics that are subscribed to."""
        if self.take_sample is not None:
            return frozenset(TOPICS)
        return frozenset(message.topic for message in self.reads)
