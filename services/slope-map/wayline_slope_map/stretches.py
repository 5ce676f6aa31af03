"""Pure: cuts a run into stretches of roads, known ones and, where none is, new ones.

The labels of the places are made sense of in turn: places on no known road are looked for on the
run's own path behind them (a second lap, a way back); what is left becomes new roads; short
matches and short holes are crossings and parallel streets, and count for nothing.
"""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from wayline.line import Floats
from wayline.matching.matcher import Matcher
from wayline.matching.transition import Moves
from wayline_slope_map.matching import CHANGE_COST, SPACING_M, Match, RoadIndex
from wayline_slope_map.roads import Road, made_road
from wayline_slope_map.track import Place

OWN_PATH = ""
"""Stands for the run's own path while no road has been made of it."""
SHORTEST_M = 100.0
"""Shorter matches are crossings; shorter holes between matches are not new roads."""
VISIBLE_BEHIND_M = 150.0
"""Nearer places behind the vehicle are where it just was, not an earlier pass."""
JUMP_M = 50.0
"""A larger disagreement between the road's distance and the travelled one is a new stretch."""

Label = Match | None


class Stretch(NamedTuple):
    """A part of a run that follows one road in one direction."""

    road: Road
    direction: int
    start_ns: int
    end_ns: int
    travelled_m: Floats
    along_m: Floats
    """Distance along the road's line at each travelled distance, shape (n,) both."""

    def bins(self) -> tuple[list[int], Floats]:
        """Bins whose centre the stretch passes, and the distance travelled at each."""
        forward = np.maximum.accumulate(self.direction * self.along_m)
        ends = [SPACING_M * side for side in (-1.0, 1.0)]
        forward = np.concatenate(([forward[0] + ends[0]], forward, [forward[-1] + ends[1]]))
        travelled = np.concatenate(
            ([self.travelled_m[0] + ends[0]], self.travelled_m, [self.travelled_m[-1] + ends[1]])
        )
        centres_m = (np.arange(self.road.bins) + 0.5) * self.road.bin_m
        passed = self.direction * centres_m
        inside = np.flatnonzero((passed >= forward[0]) & (passed <= forward[-1]))
        return inside.tolist(), np.interp(passed[inside], forward, travelled)


def cut(places: Sequence[Place], roads: Mapping[str, Road], bin_m: float) -> list[Stretch]:
    """The stretches of a run in order of time, disjoint in time."""
    labels = _with_own_path(places)
    labels = _without_short_matches(places, labels)
    labels, made = _with_new_roads(places, labels, bin_m)
    every = {**roads, **made}
    return [
        _stretch(every[match.road_id], [places[i] for i in group], [labels[i] for i in group])
        for group in _groups(places, labels)
        if (match := labels[group[0]]) is not None and len(group) > 1
    ]


def _stretch(road: Road, places: list[Place], labels: list[Label]) -> Stretch:
    matches = [match for match in labels if match is not None]
    return Stretch(
        road,
        matches[0].direction,
        places[0].t_ns,
        places[-1].t_ns,
        np.array([place.travelled_m for place in places]),
        np.array([match.along_m for match in matches]),
    )


def _with_own_path(places: Sequence[Place]) -> list[Label]:
    """Labels, those of no road matched against the run's own path further back."""
    index = RoadIndex()
    matcher = Matcher(index, jump_cost=CHANGE_COST)
    hidden: deque[Place] = deque()
    labels: list[Label] = []
    last_m = 0.0
    for place in places:
        while hidden and place.travelled_m - hidden[0].travelled_m >= VISIBLE_BEHIND_M:
            shown = hidden.popleft()
            index.add_place(
                OWN_PATH, shown.travelled_m, shown.lat_deg, shown.lon_deg, shown.course_deg
            )
        match = place.match
        if match is None:
            found = matcher.observe(place.sight, Moves.measured(place.travelled_m - last_m))
            match = Match.of(found.candidate) if found else None
            if match is None:
                hidden.append(place)
        else:
            matcher.forget()
        labels.append(match)
        last_m = place.travelled_m
    return labels


def _without_short_matches(places: Sequence[Place], labels: list[Label]) -> list[Label]:
    kept: list[Label] = [None] * len(labels)
    for group in _groups(places, labels):
        if _length_m(places, group) >= SHORTEST_M:
            for i in group:
                kept[i] = labels[i]
    return kept


def _with_new_roads(
    places: Sequence[Place], labels: list[Label], bin_m: float
) -> tuple[list[Label], dict[str, Road]]:
    """Roads made of what is on none; labels on the own path become labels on them."""
    made: dict[str, Road] = {}
    labels = list(labels)
    lookups: list[Callable[[Match], Label]] = []
    for group in _unlabelled(places, labels):
        if _length_m(places, group) < SHORTEST_M:
            continue
        road, travelled_m, along_m = _road_of([places[i] for i in group], bin_m)
        made[road.road_id] = road
        for i in group:
            along = float(np.interp(places[i].travelled_m, travelled_m, along_m))
            labels[i] = Match(road.road_id, 1, along, 0.0)
        lookups.append(_lookup(road.road_id, travelled_m, along_m))
    for i, label in enumerate(labels):
        if label is not None and label.road_id == OWN_PATH:
            found = (lookup(label) for lookup in lookups)
            labels[i] = next((match for match in found if match is not None), None)
    return labels, made


def _road_of(places: list[Place], bin_m: float) -> tuple[Road, Floats, Floats]:
    """A road, and at its vertices the distance travelled and the distance along it."""
    road, kept = made_road(
        np.array([place.lat_deg for place in places]),
        np.array([place.lon_deg for place in places]),
        bin_m=bin_m,
    )
    return road, np.array([places[i].travelled_m for i in kept]), road.line.distances_m


def _lookup(road_id: str, travelled_m: Floats, along_m: Floats) -> Callable[[Match], Label]:
    """Turns a match on the own path into one on the road made of that part of it."""

    def find(match: Match) -> Label:
        if not travelled_m[0] - SPACING_M <= match.along_m <= travelled_m[-1] + SPACING_M:
            return None
        along = float(np.interp(match.along_m, travelled_m, along_m))
        return Match(road_id, match.direction, along, match.offset_m)

    return find


def _groups(places: Sequence[Place], labels: Sequence[Label]) -> list[list[int]]:
    """Indices of places that follow one road one way; short holes do not part them."""
    groups: list[list[int]] = []
    for i, label in enumerate(labels):
        if label is None:
            continue
        if groups and _goes_on(places, labels, groups[-1][-1], i):
            groups[-1].append(i)
        else:
            groups.append([i])
    return groups


def _goes_on(places: Sequence[Place], labels: Sequence[Label], i: int, j: int) -> bool:
    before, after = labels[i], labels[j]
    if before is None or after is None or before[:2] != after[:2]:
        return False
    moved_m = places[j].travelled_m - places[i].travelled_m
    along_m = (after.along_m - before.along_m) * after.direction
    return moved_m <= SHORTEST_M + JUMP_M and abs(along_m - moved_m) <= JUMP_M


def _unlabelled(places: Sequence[Place], labels: Sequence[Label]) -> list[list[int]]:
    """Indices of places in a row that lie on no road, parted where the position was unknown."""
    groups: list[list[int]] = []
    for i, label in enumerate(labels):
        if label is not None:
            continue
        last = groups[-1][-1] if groups else None
        near = last == i - 1 and places[i].travelled_m - places[i - 1].travelled_m <= SHORTEST_M
        if near:
            groups[-1].append(i)
        else:
            groups.append([i])
    return groups


def _length_m(places: Sequence[Place], group: list[int]) -> float:
    return places[group[-1]].travelled_m - places[group[0]].travelled_m
