"""Pure: architectures side by side in outages of GPS, with the figures that papers/001 printed."""

from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np

from wayline_evaluation.figures import Figures, figures_of
from wayline_evaluation.outages import OutageScore


class Printed(NamedTuple):
    """One outage of papers/001, table 1: loose coupling in a van, scored against GPS."""

    duration_s: float
    distance_m: float
    cross_track_m: float


PAPER = "papers/001"
PAPER_OUTAGES = (
    Printed(100.0, 1600.0, 60.0),
    Printed(100.0, 930.0, 80.0),
    Printed(100.0, 1300.0, 45.0),
    Printed(200.0, 2500.0, 130.0),
)
PAPER_PCT = 5.3
"""Of the distance: their mean, as the abstract prints it."""


class ArchitectureRow(msgspec.Struct, frozen=True, kw_only=True):
    """One architecture in all outages of one duration; null where nothing is known.

    The way driven and the cross-track errors are means over the outages.
    """

    architecture: str
    duration_s: float
    count: int
    distance_m: float
    cross_track_m: float
    cross_track_pct: float | None
    horizontal_m: Figures | None = None
    horizontal_pct: Figures | None = None
    heading_deg: Figures | None = None


def architecture_rows(scores: Sequence[OutageScore]) -> list[ArchitectureRow]:
    """A row each, by duration and in the order of the scores."""
    kinds = dict.fromkeys((score.duration_s, score.filter) for score in scores)
    return [
        _row([score for score in scores if (score.duration_s, score.filter) == kind])
        for kind in sorted(kinds, key=lambda kind: kind[0])
    ]


def paper_rows() -> list[ArchitectureRow]:
    """papers/001's outages by duration."""
    durations_s = dict.fromkeys(printed.duration_s for printed in PAPER_OUTAGES)
    return [
        _paper_row([each for each in PAPER_OUTAGES if each.duration_s == duration_s])
        for duration_s in durations_s
    ]


def _row(scores: Sequence[OutageScore]) -> ArchitectureRow:
    def known(name: str) -> list[float]:
        values = (getattr(score, name) for score in scores)
        return [value for value in values if value is not None]

    shares_pct = known("cross_track_pct")
    return ArchitectureRow(
        architecture=scores[0].filter,
        duration_s=scores[0].duration_s,
        count=len(scores),
        distance_m=float(np.mean(known("distance_m"))),
        cross_track_m=float(np.mean(np.abs(known("cross_track_m")))),
        cross_track_pct=float(np.mean(shares_pct)) if shares_pct else None,
        horizontal_m=figures_of(np.array(known("horizontal_m"))),
        horizontal_pct=figures_of(np.array(known("horizontal_pct"))),
        heading_deg=figures_of(np.array(known("heading_deg"))),
    )


def _paper_row(outages: Sequence[Printed]) -> ArchitectureRow:
    shares_pct = [100.0 * each.cross_track_m / each.distance_m for each in outages]
    return ArchitectureRow(
        architecture=PAPER,
        duration_s=outages[0].duration_s,
        count=len(outages),
        distance_m=float(np.mean([each.distance_m for each in outages])),
        cross_track_m=float(np.mean([each.cross_track_m for each in outages])),
        cross_track_pct=float(np.mean(shares_pct)),
    )
