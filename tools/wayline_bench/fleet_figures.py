"""Pure: what a fleet is, and what is measured of it."""

from collections import Counter
from dataclasses import dataclass, field
from typing import NamedTuple

ROUTER = "router"
SERVICES = ("eta", "slope-map", "dashboard")
PROCESSES = (ROUTER, *SERVICES)


class Load(NamedTuple):
    """A fleet and how it is played."""

    vehicles: int
    pose_hz: float
    rounds: int
    round_s: float


@dataclass
class Fed:
    """What was sent, and what the listeners spent on it."""

    sent: Counter[str] = field(default_factory=Counter)
    """Messages by topic, all from the first one on."""
    core_shares: list[dict[str, float]] = field(default_factory=list)
    """CPU seconds a second of each process, by round."""
    memory_bytes: dict[str, int] = field(default_factory=dict)
    """What each process holds more than before the first vehicle came."""
    rounds_began_s: float = 0.0
    rounds_ended_s: float = 0.0
    """Monotonic clock."""
    late_s: float = 0.0
    """By how much a message was sent too late at worst, the rounds alone."""


class Counters(NamedTuple):
    """What a service says that it has heard and lost since its start."""

    heard: dict[str, int]
    """By topic."""
    published: dict[str, int]
    """By topic, but for health."""
    dropped: int
    """Of all topics: by the inbox, or lost on the bus."""


class Lived(NamedTuple):
    """A fleet played to Wayline."""

    fed: Fed
    counters: dict[str, Counters]
    page_bytes: int
    """Of the page's messages during the rounds."""
    snapshot_bytes: int
    sizes: dict[str, int]
    """Bytes of a message of one vehicle, by topic."""


class Bare(NamedTuple):
    """The same fleet played to bare listeners."""

    fed: Fed
    heard: dict[str, dict[str, int]]
    """By listener and topic."""


class Quiet(NamedTuple):
    """What goes on while no vehicle speaks."""

    core_shares: dict[str, float]
    messages_hz: float
    """What a listener to everything hears, heartbeats included."""
