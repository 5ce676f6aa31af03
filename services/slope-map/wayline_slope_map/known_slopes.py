"""Reads what a slope database knows of its roads, outliers judged and left out."""

import json
from collections import defaultdict
from collections.abc import Mapping
from typing import NamedTuple

import sqlalchemy as sa

from wayline_slope_map.judging import Grades, Judgement, judged
from wayline_slope_map.kept_run import unkept
from wayline_slope_map.merging import sums_of
from wayline_slope_map.records import RunBin
from wayline_slope_map.roads import Road
from wayline_slope_map.sums import BinEstimate, BinSums, estimate, without
from wayline_slope_map.tables import LEDGER, ROADS, SUMS

FUSED = "fused"
Estimates = dict[int, dict[int, BinEstimate]]


class KeptRuns(NamedTuple):
    """The runs of a road in one direction, in order of their beginning."""

    bins: tuple[Mapping[int, RunBin], ...]
    """By all sensors."""
    ends_ns: tuple[int, ...]

    def judgement(self, bin_m: float) -> Judgement:
        """What they say of each other."""
        grades = [
            Grades({i: (each.grade_pct, each.grade_std_pct) for i, each in run.items()})
            for run in self.bins
        ]
        return judged(grades, bin_m)


def estimates(connection: sa.Connection, road_id: str | None = None) -> dict[str, Estimates]:
    """The fused bins of a road or of all, by road and direction."""
    query = sa.select(
        SUMS.c.road_id,
        SUMS.c.direction,
        SUMS.c.bin_index,
        *(SUMS.c[name] for name in BinSums._fields),
    ).where(SUMS.c.sensor == FUSED)
    if road_id is not None:
        query = query.where(SUMS.c.road_id == road_id)
    sums: dict[tuple[str, int], dict[int, BinSums]] = defaultdict(dict)
    for row_road_id, direction, bin_index, *values in connection.execute(query):
        sums[row_road_id, direction][bin_index] = BinSums(*values)
    runs, bins_m = _kept_runs(connection, road_id), _bins_m(connection)
    found: dict[str, Estimates] = defaultdict(lambda: defaultdict(dict))
    for (row_road_id, direction), by_bin in sums.items():
        of_way = runs.get((row_road_id, direction), KeptRuns((), ()))
        found[row_road_id][direction] = _judged_estimates(by_bin, of_way, bins_m[row_road_id])
    return found


def _judged_estimates(
    sums: Mapping[int, BinSums], runs: KeptRuns, bin_m: float
) -> dict[int, BinEstimate]:
    """What the bins say without their outliers."""
    flagged, common_share = runs.judgement(bin_m)
    estimates = {}
    for bin_index, of_all in sums.items():
        left, count = of_all, 0
        for run, end_ns, outlying in zip(runs.bins, runs.ends_ns, flagged, strict=True):
            if bin_index in outlying:
                left, count = without(left, sums_of(run[bin_index], end_ns)), count + 1
        estimates[bin_index] = estimate(left, common_share, count)
    return estimates


def _kept_runs(connection: sa.Connection, road_id: str | None) -> dict[tuple[str, int], KeptRuns]:
    query = (
        sa.select(LEDGER.c.road_id, LEDGER.c.direction, LEDGER.c.end_ns, LEDGER.c.kept)
        .where(LEDGER.c.kept.is_not(None), sa.not_(LEDGER.c.withdrawn))
        .order_by(LEDGER.c.start_ns, LEDGER.c.vehicle_id)
    )
    if road_id is not None:
        query = query.where(LEDGER.c.road_id == road_id)
    found: dict[tuple[str, int], KeptRuns] = {}
    for of_road_id, direction, end_ns, data in connection.execute(query):
        before = found.get((of_road_id, direction), KeptRuns((), ()))
        fused = {each.bin_index: each for each in unkept(data) if each.sensor == FUSED}
        found[of_road_id, direction] = KeptRuns((*before.bins, fused), (*before.ends_ns, end_ns))
    return found


def _bins_m(connection: sa.Connection) -> dict[str, float]:
    return {row[0]: row[1] for row in connection.execute(sa.select(ROADS.c.road_id, ROADS.c.bin_m))}


def roads(connection: sa.Connection, road_id: str | None = None) -> list[Road]:
    """A road or all of them, in order of id."""
    query = sa.select(ROADS).order_by(ROADS.c.road_id)
    if road_id is not None:
        query = query.where(ROADS.c.road_id == road_id)
    return [
        Road(
            row.road_id,
            row.bin_m,
            row.loop,
            row.is_route,
            tuple((lat_deg, lon_deg) for lat_deg, lon_deg in json.loads(row.line)),
        )
        for row in connection.execute(query)
    ]
