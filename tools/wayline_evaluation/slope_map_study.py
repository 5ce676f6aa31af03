"""`wayline evaluate slope-map`: drives learned one after the other, and the map after each."""

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec
import numpy as np

from wayline.database import open_database
from wayline.geo import WGS84, wrap_180
from wayline_evaluation.estimates import Floats
from wayline_evaluation.reference import Reference
from wayline_evaluation.replays import Progressed, drive_name, needed_truth
from wayline_replay.replay import replay
from wayline_slope_map.export import ExportRow, export_rows

NEAR_M = 30.0
"""A bin farther from the first drive's way is not of its road."""
ALIKE_DEG = 60.0
"""Headings that differ by more are of the other direction."""


class MapAccuracy(msgspec.Struct, frozen=True, kw_only=True):
    """The map's fused grade after a number of runs."""

    runs: int
    bins: int
    rms_pct: float
    mean_pct: float
    """Mean error, uphill positive."""
    std_pct: float
    """Root mean square of what is claimed."""
    inside_share: float
    """Share of the bins whose truth lies within one claimed std."""
    flagged_bins: int


class MapReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate slope-map --json` writes."""

    drives: tuple[str, ...]
    after: tuple[MapAccuracy, ...]


def map_study(folders: Sequence[Path], progressed: Progressed) -> MapReport:
    """Replay drives of one road in order into one database. Raises InputError."""
    truth = needed_truth(folders[0])
    return MapReport(
        drives=tuple(drive_name(folder) for folder in folders),
        after=tuple(_learned(folders, truth, progressed)),
    )


def _learned(
    folders: Sequence[Path], truth: Reference, progressed: Progressed
) -> Iterator[MapAccuracy]:
    with tempfile.TemporaryDirectory(prefix="wayline-evaluate-") as temporary:
        url = f"sqlite:///{temporary}/slope.db"
        for runs, folder in enumerate(folders, start=1):
            replay(folder, Path(temporary) / str(runs), database_url=url)
            progressed(runs, len(folders))
            engine = open_database(url, "wayline_slope_map", create=False)
            try:
                yield map_accuracy(list(export_rows(engine)), truth, runs)
            finally:
                engine.dispose()


def map_accuracy(rows: Sequence[ExportRow], truth: Reference, runs: int) -> MapAccuracy:
    """Every bin beside the truth where it was nearest, if that is the same road and direction."""
    places = _nearest(rows, truth)
    told = [(row, place) for row, place in zip(rows, places, strict=True) if place is not None]
    errors = np.array([row.grade_pct - truth.grades_pct[place] for row, place in told])
    stds = np.array([row.grade_std_pct for row, _ in told])
    return MapAccuracy(
        runs=runs,
        bins=len(told),
        rms_pct=_rms(errors),
        mean_pct=float(np.mean(errors)),
        std_pct=_rms(stds),
        inside_share=float(np.mean(np.abs(errors) < stds)),
        flagged_bins=sum(row.flagged_runs > 0 for row, _ in told),
    )


def _nearest(rows: Sequence[ExportRow], truth: Reference) -> list[int | None]:
    """The truth's sample next to each bin, None where it is none of this way."""
    found: list[int | None] = []
    for row in rows:
        count = len(truth.lats_deg)
        _, _, apart_m = WGS84.inv(
            np.full(count, row.lon_deg), np.full(count, row.lat_deg), truth.lons_deg, truth.lats_deg
        )
        place = int(np.nanargmin(apart_m))
        turned_deg = abs(wrap_180(row.heading_deg - float(truth.headings_deg[place])))
        is_here = apart_m[place] <= NEAR_M and turned_deg <= ALIKE_DEG
        found.append(place if is_here else None)
    return found


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
