"""What timetables say of routes, trips and stops, as answers over HTTP (SPEC section 5)."""

from collections.abc import Iterator
from urllib.parse import quote

import msgspec

from wayline.geojson import FeatureCollection
from wayline.query_error import QueryError
from wayline.route_file import route_features
from wayline.timetable.clock_times import clock_of_seconds
from wayline.timetable.model import Timetable, TimetableRoute, Trip
from wayline.timetable.runs import Runs
from wayline.timetable.trip_route import PatternRoutes
from wayline.timetable.versions import first_day


class RouteSummary(msgspec.Struct, frozen=True, kw_only=True):
    """A route and where its GeoJSON is; of a timetable's the longest pattern."""

    route_id: str
    name: str
    loop: bool
    length_m: float
    stops: int
    href: str


class RouteSummaries(msgspec.Struct, frozen=True):
    """Every route that vehicles may follow."""

    routes: tuple[RouteSummary, ...]


class TripStop(msgspec.Struct, frozen=True, kw_only=True):
    """A stop of a trip with its times by the timetable's clock, which goes past 24 hours."""

    stop_id: str
    name: str
    stop_sequence: int
    distance_m: float
    arrival: str
    departure: str
    timepoint: bool


class TripAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """A trip of a timetable; of one that is repeated the times of its first run of the day."""

    trip_id: str
    route_id: str
    direction_id: int | None
    headsign: str
    block_id: str | None
    timezone: str
    headway_s: int | None
    """Between two runs of a repeated trip."""
    stops: tuple[TripStop, ...]


class TimetableAnswers:
    """Of some feeds; lines are made when they are first asked for."""

    def __init__(self, runs: Runs) -> None:
        self._runs = runs

    def summaries(self) -> Iterator[RouteSummary]:
        """A route once, whatever feeds have it."""
        told: set[str] = set()
        for feed in self._runs.feeds:
            for route in feed.routes:
                patterns = list(self._patterns(route.route_id))
                if patterns and route.route_id not in told:
                    told.add(route.route_id)
                    yield _summary(route, patterns)

    def route(self, route_id: str) -> FeatureCollection:
        """The lines and stops of a route's patterns. Raises QueryError (404)."""
        features = [
            feature
            for pattern in self._patterns(route_id)
            for feature in route_features(pattern.some_route)
        ]
        if not features:
            raise QueryError(404, f"no route {route_id}; /v1/routes lists them")
        return FeatureCollection(features)

    def trip(self, trip_id: str) -> TripAnswer:
        """A trip by the newest feed that has it. Raises QueryError (404)."""
        for feed in sorted(self._runs.feeds, key=first_day, reverse=True):
            for trip in feed.trips:
                if trip.trip_id == trip_id:
                    return self._trip(feed, trip)
        raise QueryError(404, f"no trip {trip_id} in the timetables")

    def _trip(self, feed: Timetable, trip: Trip) -> TripAnswer:
        place = self._runs.feeds.index(feed), trip.pattern
        pattern, routes = feed.patterns[trip.pattern], self._runs.line_of(place)
        if routes is None:
            raise QueryError(404, f"trip {trip.trip_id} has no line: see wayline timetable check")
        headway_s, starts_s = _repeats(feed, trip)
        return TripAnswer(
            trip_id=trip.trip_id,
            route_id=pattern.route_id,
            direction_id=pattern.direction_id,
            headsign=trip.headsign,
            block_id=trip.block_id,
            timezone=feed.timezone,
            headway_s=headway_s,
            stops=tuple(_stops(routes, trip, starts_s)),
        )

    def _patterns(self, route_id: str) -> Iterator[PatternRoutes]:
        for at, feed in enumerate(self._runs.feeds):
            for each, pattern in enumerate(feed.patterns):
                if pattern.route_id == route_id:
                    routes = self._runs.line_of((at, each))
                    if routes is not None:
                        yield routes


def _summary(route: TimetableRoute, patterns: list[PatternRoutes]) -> RouteSummary:
    longest = max(patterns, key=lambda each: each.line.length_m)
    return RouteSummary(
        route_id=route.route_id,
        name=" ".join(filter(None, (route.short_name, route.long_name))) or route.route_id,
        loop=False,
        length_m=longest.line.length_m,
        stops=len(longest.pattern.stops),
        href=f"/v1/routes/{quote(route.route_id, safe='')}",
    )


def _repeats(feed: Timetable, trip: Trip) -> tuple[int | None, int]:
    """Seconds from run to run, None where there is one; and when the first begins."""
    found = [each for each in feed.frequencies if feed.trips[each.trip] == trip]
    if not found:
        return None, trip.starts_s
    first = min(found, key=lambda each: each.start_s)
    return first.headway_s, first.start_s


def _stops(routes: PatternRoutes, trip: Trip, starts_s: int) -> Iterator[TripStop]:
    of_trip = routes.of_trip(trip)
    plan = of_trip.plan
    for at, stop in enumerate(of_trip.route.stops):
        yield TripStop(
            stop_id=stop.stop_id,
            name=stop.name,
            stop_sequence=of_trip.sequences[at],
            distance_m=round(stop.distance_m, 1),
            arrival=clock_of_seconds(starts_s + float(plan.arrivals_s[at])),
            departure=clock_of_seconds(starts_s + float(plan.departures_s[at])),
            timepoint=bool(of_trip.timepoints[at]),
        )
