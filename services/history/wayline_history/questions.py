"""Pure: what questions to the history may say."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta, field

from wayline_history.instants import Instant, Stretch, stretch_of
from wayline_history.layouts import TrackKind

TRACK_DAYS = 31
LIST_DAYS = 366
POINTS_MAX = 100_000
EVENTS_MAX = 10_000

Unset = msgspec.UnsetType


class StretchParameters(msgspec.Struct, frozen=True, kw_only=True):
    """A stretch of time; by default the day before its end, which by default is now."""

    from_: Instant | Unset = field(default=msgspec.UNSET, name="from")
    to: Instant | Unset = msgspec.UNSET

    def stretch(self, now_ns: int, *, days_max: int | None = LIST_DAYS) -> Stretch:
        """From when to when; at most so many days. Raises QueryError (422)."""
        return stretch_of(self.from_, self.to, now_ns, days_max=days_max)


class EventsParameters(StretchParameters, frozen=True, kw_only=True):
    """What happened in a stretch of time."""

    limit: Annotated[int, Meta(ge=1, le=EVENTS_MAX, description="So many at most")] = 1_000


class TrackParameters(StretchParameters, frozen=True, kw_only=True):
    """Where a vehicle was in a stretch of time."""

    kind: Annotated[
        TrackKind,
        Meta(description="the receivers' fixes, fusion's poses, or places along the route"),
    ] = "fused"
    step_s: Annotated[float, Meta(ge=0.0, le=86_400.0, description="one point in so many")] = 0.0

    def stretch(self, now_ns: int, *, days_max: int | None = TRACK_DAYS) -> Stretch:
        """From when to when; at most so many days. Raises QueryError (422)."""
        return stretch_of(self.from_, self.to, now_ns, days_max=days_max)


class PagedTrackParameters(TrackParameters, frozen=True, kw_only=True):
    """A track in pages: `next` of one is `from` of the next."""

    limit: Annotated[int, Meta(ge=1, le=POINTS_MAX, description="So many points at most")] = (
        POINTS_MAX
    )


Format = Literal["json", "gpx", "csv", "geojson"]
