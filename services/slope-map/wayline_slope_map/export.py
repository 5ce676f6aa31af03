"""The slope database as rows for people and programs, one a bin and direction (SPEC section 4)."""

from collections.abc import Iterator
from typing import NamedTuple

import sqlalchemy as sa

from wayline.geo import wrap_360
from wayline.rfc3339 import rfc3339
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.store import SlopeStore
from wayline_slope_map.sums import BinEstimate


class ExportRow(NamedTuple):
    """A bin, named by its centre; heading and grade are those of the direction of travel.

    `updated` is RFC 3339 UTC with milliseconds.
    """

    road_id: str
    distance_m: float
    lat_deg: float
    lon_deg: float
    heading_deg: float
    grade_pct: float
    grade_std_pct: float
    alt_m: float | None
    runs: int
    updated: str
    flagged_runs: int
    """Runs that said something else here and do not count."""


def export_rows(engine: sa.Engine) -> Iterator[ExportRow]:
    """Every known bin by road, direction and distance along the road's line."""
    for profile in SlopeStore(engine).load_roads():
        for direction in sorted(profile.bins, reverse=True):
            yield from profile_rows(profile, direction)


def profile_rows(profile: RoadProfile, direction: int) -> Iterator[ExportRow]:
    """The known bins of one direction of a road, by distance along its line."""
    for bin_index, known in sorted(profile.bins.get(direction, {}).items()):
        yield _row(profile, direction, bin_index, known)


def _row(profile: RoadProfile, direction: int, bin_index: int, known: BinEstimate) -> ExportRow:
    distance_m = profile.road.centre_m(bin_index)
    lat_deg, lon_deg, heading_deg = profile.road.line.point_at(distance_m)
    return ExportRow(
        road_id=profile.road.road_id,
        distance_m=distance_m,
        lat_deg=round(lat_deg, 7),
        lon_deg=round(lon_deg, 7),
        heading_deg=round(heading_deg if direction > 0 else wrap_360(heading_deg + 180.0), 2),
        grade_pct=round(known.grade_pct, 3),
        grade_std_pct=round(known.grade_std_pct, 3),
        alt_m=None if known.alt_m is None else round(known.alt_m, 2),
        runs=known.runs,
        updated=rfc3339(known.updated_ns),
        flagged_runs=known.flagged_runs,
    )
