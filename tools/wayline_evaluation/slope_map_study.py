"""`wayline evaluate slope-map`: drives learned one after the other, and the map after each."""

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.database import open_database
from wayline_evaluation.estimates import Floats
from wayline_evaluation.reference import Reference
from wayline_evaluation.replays import Progressed, drive_name, needed_truth
from wayline_evaluation.slope_hills import hills_shift_m
from wayline_evaluation.slope_places import Places, nearest_to
from wayline_replay.replay import replay
from wayline_slope_map.export import ExportRow, export_rows


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
    hills_shift_m: float | None
    """How much farther along the road its hills come than they are."""
    flagged_bins: int


class MapReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate slope-map --json` writes."""

    drives: tuple[str, ...]
    after: tuple[MapAccuracy, ...]


class MapShown(NamedTuple):
    """The map beside the truth, for plots, shape (n,) each, in order of the way."""

    distances_m: Floats
    grades_pct: Floats
    stds_pct: Floats
    true_pct: Floats
    flagged: NDArray[np.bool_]
    """Where a run does not count."""


def map_study(folders: Sequence[Path], progressed: Progressed) -> tuple[MapReport, list[MapShown]]:
    """Replay drives of one road in order into one database. Raises InputError."""
    truth = needed_truth(folders[0])
    shown = list(_learned(folders, truth, progressed))
    report = MapReport(
        drives=tuple(drive_name(folder) for folder in folders),
        after=tuple(accuracy_of(each, runs) for runs, each in enumerate(shown, start=1)),
    )
    return report, shown


def _learned(
    folders: Sequence[Path], truth: Reference, progressed: Progressed
) -> Iterator[MapShown]:
    with tempfile.TemporaryDirectory(prefix="wayline-evaluate-") as temporary:
        url = f"sqlite:///{temporary}/slope.db"
        for runs, folder in enumerate(folders, start=1):
            replay(folder, Path(temporary) / str(runs), database_url=url)
            progressed(runs, len(folders))
            engine = open_database(url, "wayline_slope_map", create=False)
            try:
                rows = list(export_rows(engine))
            finally:
                engine.dispose()
            yield map_shown(rows, truth)


def map_accuracy(rows: Sequence[ExportRow], truth: Reference, runs: int) -> MapAccuracy:
    """Every bin beside the truth where it was nearest, if that is the same road and direction."""
    return accuracy_of(map_shown(rows, truth), runs)


def accuracy_of(shown: MapShown, runs: int) -> MapAccuracy:
    """The map after so many runs."""
    errors_pct = shown.grades_pct - shown.true_pct
    return MapAccuracy(
        runs=runs,
        bins=len(errors_pct),
        rms_pct=_rms(errors_pct),
        mean_pct=float(np.mean(errors_pct)),
        std_pct=_rms(shown.stds_pct),
        inside_share=float(np.mean(np.abs(errors_pct) < shown.stds_pct)),
        hills_shift_m=_hills_shift_m(shown),
        flagged_bins=int(np.count_nonzero(shown.flagged)),
    )


def map_shown(rows: Sequence[ExportRow], truth: Reference) -> MapShown:
    """The bins of the truth's way, in its order."""
    told = sorted(_on_this_way(rows, truth), key=lambda each: each[1])
    places = [place for _, place in told]
    return MapShown(
        truth.distances_m[places],
        np.array([row.grade_pct for row, _ in told]),
        np.array([row.grade_std_pct for row, _ in told]),
        truth.grades_pct[places],
        np.array([row.flagged_runs > 0 for row, _ in told], dtype=np.bool_),
    )


def _hills_shift_m(shown: MapShown) -> float | None:
    """Where the way is driven once; else two places of the map share one of the truth."""
    ahead_m = np.diff(shown.distances_m)
    if len(ahead_m) == 0 or not np.all(ahead_m > 0.0):
        return None
    return hills_shift_m(shown.distances_m, shown.grades_pct, shown.true_pct)


def _on_this_way(rows: Sequence[ExportRow], truth: Reference) -> list[tuple[ExportRow, int]]:
    """The bins of this road and direction, with the truth's sample next to each."""
    bins = Places(*np.array([(row.lat_deg, row.lon_deg, row.heading_deg) for row in rows]).T)
    way = Places(truth.lats_deg, truth.lons_deg, truth.headings_deg)
    places, is_near = nearest_to(bins, way)
    return [(rows[at], int(places[at])) for at in np.flatnonzero(is_near).tolist()]


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
