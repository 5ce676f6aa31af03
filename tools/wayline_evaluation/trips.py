"""Pure: how well the trip that a vehicle runs was found, against the trips that it ran.

A second counts where the vehicle is on a trip; it is *driven* once it has set out on that, layovers
are not. It is *alone* once the vehicle has driven
`FOLLOWED_M` where no other route runs its way, and *later* from then on to the end of the drive,
also on streets that lines share.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.geo import WGS84
from wayline.messages import GpsFix, Progress
from wayline.timetable.model import Timetable
from wayline.timetable.runs import Runs
from wayline_evaluation.estimates import Floats

Flags = NDArray[np.bool_]

FOLLOWED_M = 1_000.0
BESIDE_M = 60.0
"""Another route's line so near is on the same street."""
SAME_WAY_DEG = 60.0
LOOKED_EVERY_M = 50.0
SET_OUT_M = 60.0


class TripScore(msgspec.Struct, frozen=True, kw_only=True):
    """One drive; shares are of seconds on a trip, null where there are none."""

    drive: str
    every_s: float
    """Median time between two fixes."""
    seconds: int
    told_share: float | None
    """Any trip was named."""
    right_share: float | None
    alone_share: float | None
    """Right while the vehicle was alone."""
    alone_driven_share: float | None
    """Right while it was alone and no layover: at its end a trip is known by the next report."""
    later_share: float | None
    """Right from the first such second on."""
    wrong_way_reports: int
    """Most fixes in a row behind which a trip of another direction was followed."""
    idle_share: float | None
    """A trip was named while the vehicle ran none, of those seconds."""


class TripReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate trips --json` writes."""

    scores: tuple[TripScore, ...]
    pooled: TripScore


@dataclass(frozen=True, slots=True)
class TripTruth:
    """A vehicle's trips; shape (n,) each, times ascending."""

    times_s: Floats
    lats_deg: Floats
    lons_deg: Floats
    trips: NDArray[np.str_]
    """Empty while the vehicle runs none."""


@dataclass(frozen=True, slots=True)
class Told:
    """What was told at each second of the truth; shape (n,) each."""

    trips: NDArray[np.str_]
    """Empty where none was named."""
    directions: NDArray[np.intp]
    """-1 where no trip was followed or its direction is not known."""


@dataclass(frozen=True, slots=True)
class TripRun:
    """One drive: what its score is made of, so that drives can be pooled."""

    score: TripScore
    on_trip: Flags
    told: Flags
    right: Flags
    alone: Flags
    driven: Flags


def trip_run(
    drive: str,
    truth: TripTruth,
    progress: Sequence[Progress],
    fixes: Sequence[GpsFix],
    timetables: Sequence[Timetable],
) -> TripRun:
    """Score a replay with a drive's trips."""
    told = _told(truth.times_s, progress)
    on_trip = truth.trips != ""
    right = on_trip & (told.trips == truth.trips)
    travelled_m = _travelled_m(truth)
    alone = _alone(truth, travelled_m, Streets(timetables)) & on_trip
    driven = _driven(truth, travelled_m)
    fixes_s = np.array([fix.t_ns * 1e-9 for fix in fixes if fix.valid])
    directions = {
        trip.trip_id: feed.patterns[trip.pattern].direction_id
        for feed in timetables
        for trip in feed.trips
    }
    ways = np.array([_number(directions.get(str(trip_id))) for trip_id in truth.trips])
    wrong_way = (ways >= 0) & (told.directions >= 0) & (ways != told.directions)
    score = _score(
        drive,
        every_s=float(np.median(np.diff(fixes_s))) if len(fixes_s) > 1 else 0.0,
        parts=[(on_trip, told.trips != "", right, alone, driven)],
        wrong_way_reports=_longest_of(wrong_way, truth.times_s, fixes_s),
    )
    return TripRun(score, on_trip, told.trips != "", right, alone, driven)


def pooled(runs: Sequence[TripRun]) -> TripScore:
    """All drives as one; the longest of what was longest."""
    return _score(
        "all",
        every_s=float(np.median([run.score.every_s for run in runs])),
        parts=[(run.on_trip, run.told, run.right, run.alone, run.driven) for run in runs],
        wrong_way_reports=max(run.score.wrong_way_reports for run in runs),
    )


class Streets:
    """Which routes run where, and which way."""

    def __init__(self, timetables: Sequence[Timetable]) -> None:
        runs = Runs(timetables)
        places = [
            (feed, at) for feed, each in enumerate(timetables) for at in range(len(each.patterns))
        ]
        found = [runs.line_of(place) for place in places]
        self._patterns = [(each.pattern.route_id, each.line) for each in found if each is not None]
        self._of_trips = {
            trip.trip_id: runs.line_of((feed, trip.pattern))
            for feed, each in enumerate(timetables)
            for trip in each.trips
        }

    def are_shared(self, truth: TripTruth, at: int) -> bool:
        """Whether another route than the vehicle's runs its way where it is; so without one."""
        routes = self._of_trips.get(str(truth.trips[at]))
        if routes is None:
            return True
        lat_deg, lon_deg = float(truth.lats_deg[at]), float(truth.lons_deg[at])
        own = routes.line.project(lat_deg, lon_deg)
        if own is None:
            return True
        beside = (
            line.project(
                lat_deg, lon_deg,
                heading_deg=own.heading_deg, heading_tolerance_deg=SAME_WAY_DEG,
            )
            for route_id, line in self._patterns
            if route_id != routes.pattern.route_id
        )  # fmt: skip
        return any(each is not None and abs(each.cross_track_m) <= BESIDE_M for each in beside)


def _score(
    drive: str,
    *,
    every_s: float,
    parts: Sequence[tuple[Flags, Flags, Flags, Flags, Flags]],
    wrong_way_reports: int,
) -> TripScore:
    on_trip, told, right, alone, driven = (
        np.concatenate(each) for each in zip(*parts, strict=True)
    )
    later = np.concatenate([np.maximum.accumulate(part[3]) & part[0] for part in parts])
    return TripScore(
        drive=drive,
        every_s=every_s,
        seconds=int(on_trip.sum()),
        told_share=_share(told, on_trip),
        right_share=_share(right, on_trip),
        alone_share=_share(right, alone),
        alone_driven_share=_share(right, alone & driven),
        later_share=_share(right, later),
        wrong_way_reports=wrong_way_reports,
        idle_share=_share(told, ~on_trip),
    )


def _share(what: Flags, of: Flags) -> float | None:
    return float(what[of].mean()) if of.any() else None


def _number(direction_id: int | None) -> int:
    return -1 if direction_id is None else direction_id


def _told(times_s: Floats, progress: Iterable[Progress]) -> Told:
    """What was told in each second; nothing where nothing was."""
    places = {round(time_s): at for at, time_s in enumerate(times_s.tolist())}
    trips = [""] * len(times_s)
    directions = np.full(len(times_s), -1)
    for each in progress:
        at = places.get(round(each.t_ns * 1e-9))
        if at is not None:
            trips[at] = each.trip_id or ""
            directions[at] = _number(each.direction_id)
    return Told(np.array(trips), directions)


def _longest_of(wrong: Flags, times_s: Floats, fixes_s: Floats) -> int:
    """Most fixes in a row of which each left something wrong until the next one came."""
    before_next = np.searchsorted(times_s, fixes_s[1:]) - 1
    longest = lasting = 0
    for is_wrong in wrong[np.clip(before_next, 0, len(wrong) - 1)].tolist():
        lasting = lasting + 1 if is_wrong else 0
        longest = max(longest, lasting)
    return longest


def _travelled_m(truth: TripTruth) -> Floats:
    _, _, steps_m = WGS84.inv(
        truth.lons_deg[:-1], truth.lats_deg[:-1], truth.lons_deg[1:], truth.lats_deg[1:]
    )
    return np.concatenate(([0.0], np.cumsum(steps_m)))


def _driven(truth: TripTruth, travelled_m: Floats) -> Flags:
    """Whether the vehicle has driven SET_OUT_M since its trip began."""
    begins = np.concatenate(([True], truth.trips[1:] != truth.trips[:-1]))
    since = np.maximum.accumulate(np.where(begins, np.arange(len(begins)), 0))
    return np.asarray(travelled_m - travelled_m[since] >= SET_OUT_M)


def _alone(truth: TripTruth, travelled_m: Floats, streets: Streets) -> Flags:
    """Whether the vehicle has driven FOLLOWED_M since another route ran its way, or it began."""
    looked = np.flatnonzero(np.diff(travelled_m // LOOKED_EVERY_M, prepend=-1.0) > 0.0)
    shared = [at for at in looked.tolist() if streets.are_shared(truth, at)]
    since = np.zeros(len(travelled_m), dtype=np.intp)
    since[shared] = shared
    since = np.maximum.accumulate(since)
    begins = int(np.argmax(truth.trips != ""))
    return travelled_m - travelled_m[np.maximum(since, begins)] >= FOLLOWED_M
