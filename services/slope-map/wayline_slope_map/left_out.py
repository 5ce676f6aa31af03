"""Pure: what of a drive teaches no road, from where to where, and why."""

from collections.abc import Iterator
from typing import Literal, NamedTuple

from wayline.core import Record

Altimeter = Literal["gps", "barometer", "torque", "vehicle"]
SHORTEST_M = 100.0
"""Shorter is a gear change, a bridge overhead, a queue at a light: nobody would look for it."""

UNPLACED = "the position is not known well enough"
LEAPT = "the position went farther than the wheels: a ferry, or a receiver that lied"
WALKED = "walking pace: a car park, a yard or a queue, and the road beside it"
NO_HEIGHT = "nothing told of the height"
NO_ROAD = "no hundred metres along one road"
UNSURE = "the grade is not known well enough"
TOO_STEEP = "no road is so steep"
NOT_ON_EARTH = "no vehicle is so high or so low"
HARDLY_KNOWN = "the receiver itself hardly knows its altitude"
COARSE = "the steps of the pressure are too coarse"
BACKWARDS = "driven backwards"
COUNTED = "of a time that the map has of this vehicle already"


class LeftOut(Record, frozen=True, kw_only=True):
    """A part of a drive that teaches nothing, or a sensor that is not used over it."""

    vehicle_id: str
    sensor: Altimeter | None
    """None where the whole part is left out."""
    reason: str
    """In plain words; the same cause has the same words."""
    start_ns: int
    end_ns: int
    length_m: float
    """Travelled by the wheels."""
    start_lat_deg: float | None = None
    """Of the nearest place that was known; None where none was near."""
    start_lon_deg: float | None = None
    end_lat_deg: float | None = None
    end_lon_deg: float | None = None


class Span(NamedTuple):
    """As `LeftOut`, before it is known where on earth that is."""

    sensor: Altimeter | None
    reason: str
    start_ns: int
    end_ns: int
    from_m: float
    to_m: float
    """Distances travelled."""

    @property
    def is_told(self) -> bool:
        """Whether it is long enough to be told of."""
        return self.to_m - self.from_m >= SHORTEST_M


class Spans:
    """Puts together what is left out for one reason, message by message.

    Each subject is told by messages of its own: `position`, a sensor, one receiver of several.
    """

    def __init__(self) -> None:
        self._open: dict[str, Span] = {}
        self._closed: list[Span] = []

    def note(
        self, subject: str, reason: str | None, t_ns: int, at_m: float, sensor: Altimeter | None
    ) -> None:
        """Take a message that is left out, or with None one that is used, at a distance."""
        before = self._open.get(subject)
        if before is not None and before.reason == reason:
            self._open[subject] = before._replace(end_ns=t_ns, to_m=at_m)
            return
        if before is not None:
            self._close(subject)
        if reason is not None:
            self._open[subject] = Span(sensor, reason, t_ns, t_ns, at_m, at_m)

    def take(self) -> Iterator[Span]:
        """Those so far that are to be told of; what goes on begins anew."""
        for subject in tuple(self._open):
            self._close(subject)
        taken, self._closed = self._closed, []
        yield from taken

    def _close(self, subject: str) -> None:
        span = self._open.pop(subject)
        if span.is_told:
            self._closed.append(span)
