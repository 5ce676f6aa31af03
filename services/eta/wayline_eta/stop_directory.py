"""Pure: every stop that vehicles may come to, and which are near a place (SPEC section 5)."""

import itertools
from collections.abc import Iterable
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta

from wayline.geo import metres_per_degree
from wayline.messages import LIST_MAX
from wayline.query_error import QueryError
from wayline.route import Route
from wayline.stops import Stop
from wayline.timetable.model import Timetable, TimetableStop

RADIUS_M = 500.0
"""Of what is near, where nobody says."""
PLACE = r"^-?\d+(\.\d+)?,-?\d+(\.\d+)?$"


class StopsParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What a question for stops may say."""

    near: (
        Annotated[str, Meta(pattern=PLACE, description="Latitude,longitude in degrees")]
        | msgspec.UnsetType
    ) = msgspec.UNSET
    radius_m: Annotated[
        float, Meta(gt=0.0, le=20_000.0, description="How far from the place at most")
    ] = RADIUS_M
    limit: Annotated[int, Meta(ge=1, le=LIST_MAX, description="So many at most")] = 100


class StopAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """A stop; `distance_m` is how far it is from where it was asked for."""

    stop_id: str
    name: str
    lat_deg: float
    lon_deg: float
    distance_m: float | None = None


class StopList(msgspec.Struct, frozen=True):
    """Stops, nearest first, else by id."""

    stops: tuple[StopAnswer, ...]


class StopDirectory:
    """Stops of routes and of timetables, each once."""

    def __init__(self, routes: Iterable[Route] = (), timetables: Iterable[Timetable] = ()) -> None:
        of_routes = (stop for route in routes for stop in route.stops)
        of_feeds = (stop for feed in timetables for stop in feed.stops)
        found: dict[str, StopAnswer] = {}
        for stop in itertools.chain(map(_answer, of_routes), map(_answer, of_feeds)):
            found.setdefault(stop.stop_id, stop)
        self._stops = found
        self._ordered = sorted(found.values(), key=lambda stop: stop.stop_id)
        self._lats_deg = np.array([stop.lat_deg for stop in self._ordered])
        self._lons_deg = np.array([stop.lon_deg for stop in self._ordered])

    def __contains__(self, stop_id: str) -> bool:
        return stop_id in self._stops

    def answer(self, asked: StopsParameters) -> StopList:
        """The stops that are asked for. Raises QueryError (422) for a place that is none."""
        if asked.near is msgspec.UNSET:
            return StopList(tuple(self._ordered[: asked.limit]))
        lat_deg, lon_deg = map(float, asked.near.split(","))
        if abs(lat_deg) > 90.0 or abs(lon_deg) > 180.0:
            raise QueryError(422, "is no latitude,longitude", parameter="near")
        north_m, east_m = metres_per_degree(lat_deg)
        turned_deg = (self._lons_deg - lon_deg + 180.0) % 360.0 - 180.0
        apart_m = np.hypot((self._lats_deg - lat_deg) * north_m, turned_deg * east_m)
        near = [at for at in np.argsort(apart_m, kind="stable") if apart_m[at] <= asked.radius_m]
        return StopList(
            tuple(
                msgspec.structs.replace(self._ordered[at], distance_m=round(float(apart_m[at]), 1))
                for at in near[: asked.limit]
            )
        )


def _answer(stop: Stop | TimetableStop) -> StopAnswer:
    return StopAnswer(
        stop_id=stop.stop_id, name=stop.name, lat_deg=stop.lat_deg, lon_deg=stop.lon_deg
    )
