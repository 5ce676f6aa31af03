"""How good the predictions of all vehicles were, by route and day, shared with who answers.

One thread calls `take`, any others the rest.
"""

import datetime as dt
import threading
from collections import defaultdict
from typing import Annotated

import msgspec
from msgspec import Meta

from wayline_eta.records import SCORED_DAYS_MAX, Scored, ScoredDay, day_of
from wayline_eta.scores import NOTHING, Score, Sums, added, score_of

ROUTE_DAYS_MAX = 50_000
"""Those of the oldest days are forgotten first."""
EPOCH = dt.date(1970, 1, 1)


class AccuracyParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What a question for the accuracy may say."""

    route_id: Annotated[str, Meta(description="Only of this route")] | msgspec.UnsetType = (
        msgspec.UNSET
    )
    days: Annotated[int, Meta(ge=1, le=SCORED_DAYS_MAX, description="The newest so many, UTC")] = 7


class AccuracyAnswer(Score, frozen=True, kw_only=True):
    """How good the predictions of some days were, of one route or of all."""

    route_id: str | None
    first_day: str | None
    """UTC; null where nothing has been scored."""
    last_day: str | None


class Accuracy:
    """Sums by route and day; a day is UTC's, days are counted from the newest one back."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._sums: dict[tuple[int, str], Sums] = {}

    def take(self, scored: Scored | ScoredDay) -> None:
        """Add what a minute of a vehicle has brought, or know a whole day's as a database has it.

        A database answers each minute with the day that holds it; told again it changes nothing.
        """
        with self._lock:
            if isinstance(scored, ScoredDay):
                self._know((scored.day, scored.route_id), scored.sums)
            else:
                key = day_of(scored.t_ns), scored.route_id
                self._know(key, self._sums.get(key, NOTHING).plus(scored.sums))

    def _know(self, key: tuple[int, str], sums: Sums) -> None:
        is_new = key not in self._sums
        self._sums[key] = sums
        if is_new:
            self._forget()

    def answer(self, asked: AccuracyParameters) -> AccuracyAnswer:
        """What is asked for."""
        route_id = None if asked.route_id is msgspec.UNSET else asked.route_id
        chosen = self._newest(asked.days)
        of_route = {key: sums for key, sums in chosen.items() if route_id in {None, key[1]}}
        score = score_of(added(of_route.values()))
        return AccuracyAnswer(
            route_id=route_id,
            first_day=_date(min((day for day, _ in of_route), default=None)),
            last_day=_date(max((day for day, _ in of_route), default=None)),
            **msgspec.structs.asdict(score),
        )

    def by_route(self, days: int) -> dict[str, Score]:
        """Of the newest `days` days, each route."""
        of_routes: defaultdict[str, list[Sums]] = defaultdict(list)
        for (_, route_id), sums in self._newest(days).items():
            of_routes[route_id].append(sums)
        return {route_id: score_of(added(sums)) for route_id, sums in of_routes.items()}

    def _newest(self, days: int) -> dict[tuple[int, str], Sums]:
        with self._lock:
            newest = max((day for day, _ in self._sums), default=0)
            return {key: sums for key, sums in self._sums.items() if key[0] > newest - days}

    def _forget(self) -> None:
        oldest = max(day for day, _ in self._sums) - SCORED_DAYS_MAX
        kept = sorted(key for key in self._sums if key[0] > oldest)[-ROUTE_DAYS_MAX:]
        self._sums = {key: self._sums[key] for key in kept}


def _date(day: int | None) -> str | None:
    return None if day is None else (EPOCH + dt.timedelta(days=day)).isoformat()
