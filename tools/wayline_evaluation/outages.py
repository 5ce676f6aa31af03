"""Pure: how far dead reckoning drifts in outages of GPS, as papers/001 table 1 lists them."""

from collections.abc import Sequence

import msgspec
import numpy as np

from wayline_evaluation.estimates import Estimates
from wayline_evaluation.figures import Figures, figures_of, ratio_of
from wayline_evaluation.growth import Drift, Growth, growths
from wayline_evaluation.pose_errors import pose_errors
from wayline_evaluation.reference import Kind, Reference
from wayline_replay.outages import Outage

SHORTEST_M = 10.0
"""A vehicle that hardly moved has no error in percent of its way."""
SUMMED_UP = (
    "horizontal_m",
    "horizontal_pct",
    "cross_track_m",
    "cross_track_pct",
    "along_track_m",
    "heading_deg",
)


class OutageScore(msgspec.Struct, frozen=True, kw_only=True):
    """One outage; errors are those of the last instant before GPS returns, without alignment.

    Along-track is positive ahead of the reference, cross-track right of it.
    """

    drive: str
    filter: str
    pass_number: int
    start_s: float
    """From the drive's smallest t_ns."""
    duration_s: float
    distance_m: float
    """Travelled from its start to the instant that is scored."""
    cross_track_m: float
    along_track_m: float
    horizontal_m: float
    heading_deg: float | None
    horizontal_pct: float | None
    """Of the distance; null where the vehicle stood."""
    cross_track_pct: float | None


class OutageSummary(msgspec.Struct, frozen=True, kw_only=True):
    """All outages of one duration that one filter went through."""

    filter: str
    duration_s: float
    count: int
    horizontal_m: Figures | None
    horizontal_pct: Figures | None
    cross_track_m: Figures | None
    cross_track_pct: Figures | None
    along_track_m: Figures | None
    heading_deg: Figures | None


class PassSummary(msgspec.Struct, frozen=True, kw_only=True):
    """The outages of one pass, pooled over the drives."""

    filter: str
    duration_s: float
    pass_number: int
    first_s: float
    """Start of the pass's first outage."""
    horizontal_m: Figures | None


class OutageReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate outages --json` writes."""

    reference: Kind
    summaries: tuple[OutageSummary, ...]
    passes: tuple[PassSummary, ...]
    ratios: dict[str, Figures]
    """Fusion's horizontal_m over the yardstick's, by duration in seconds; empty without one."""
    outages: tuple[OutageScore, ...]
    skipped: int
    """Outages without a reference or a pose at their end."""
    growths: tuple[Growth, ...] = ()


def schedule(
    *,
    length_s: float,
    every_s: float,
    start_s: float,
    passes: int,
    until_s: float,
    satellites: int = 0,
) -> list[list[Outage]]:
    """Outages of every pass that end within the drive; each pass begins a share of `every_s` later.

    The same for every run of a study: nothing is drawn at random.
    """
    firsts = [start_s + every_s * number / passes for number in range(passes)]
    return [
        [
            Outage(float(begin_s), length_s, satellites)
            for begin_s in np.arange(first_s, until_s - length_s, every_s)
        ]
        for first_s in firsts
    ]


def score_outage(
    outage: Outage,
    *,
    drive: str,
    name: str,
    pass_number: int,
    drive_start_s: float,
    estimates: Estimates,
    reference: Reference,
) -> OutageScore | None:
    """Score one outage; None without reference or pose in it. `drive_start_s` is Unix time."""
    begin_s = drive_start_s + outage.start_s
    # what is judged by fixes is judged at a fix, what is judged by the truth at a pose
    clock_s = reference.times_s if reference.kind == "fixes" else estimates.times_s
    inside = np.flatnonzero((clock_s >= begin_s) & (clock_s < begin_s + outage.length_s))
    if len(inside) == 0:
        return None
    instants_s = np.array([begin_s, clock_s[inside[-1]]])
    there = reference.at(instants_s)
    errors = pose_errors(estimates.at(instants_s), there)
    horizontal_m = float(errors.horizontal_m[1])
    travelled_m = np.interp(instants_s, reference.times_s, reference.distances_m)
    distance_m = float(travelled_m[1] - travelled_m[0])
    if np.isnan(horizontal_m) or np.isnan(errors.cross_track_m[1]):
        return None
    cross_m, heading_deg = float(errors.cross_track_m[1]), float(errors.heading_deg[1])
    return OutageScore(
        drive=drive,
        filter=name,
        pass_number=pass_number,
        start_s=outage.start_s,
        duration_s=outage.length_s,
        distance_m=distance_m,
        cross_track_m=cross_m,
        along_track_m=float(errors.along_track_m[1]),
        horizontal_m=horizontal_m,
        heading_deg=None if np.isnan(heading_deg) else heading_deg,
        horizontal_pct=_percent(horizontal_m, distance_m),
        cross_track_pct=_percent(abs(cross_m), distance_m),
    )


def outage_report(
    reference: Kind, scores: Sequence[OutageScore], skipped: int, drifts: Sequence[Drift] = ()
) -> OutageReport:
    """Sum up the scores of all drives."""
    kinds = sorted({(s.duration_s, s.filter) for s in scores})
    summaries = tuple(
        _summary([s for s in scores if (s.duration_s, s.filter) == kind]) for kind in kinds
    )
    runs = sorted({(s.duration_s, s.filter, s.pass_number) for s in scores})
    passes = tuple(
        _pass([s for s in scores if (s.duration_s, s.filter, s.pass_number) == run]) for run in runs
    )
    return OutageReport(
        reference=reference,
        summaries=summaries,
        passes=passes,
        ratios=_ratios(summaries),
        outages=tuple(scores),
        skipped=skipped,
        growths=tuple(growths(drifts)),
    )


def _summary(scores: Sequence[OutageScore]) -> OutageSummary:
    def figures(name: str) -> Figures | None:
        return figures_of(np.array([getattr(s, name) for s in scores], dtype=np.float64))

    return OutageSummary(
        filter=scores[0].filter,
        duration_s=scores[0].duration_s,
        count=len(scores),
        **{name: figures(name) for name in SUMMED_UP},
    )


def _pass(scores: Sequence[OutageScore]) -> PassSummary:
    return PassSummary(
        filter=scores[0].filter,
        duration_s=scores[0].duration_s,
        pass_number=scores[0].pass_number,
        first_s=min(s.start_s for s in scores),
        horizontal_m=figures_of(np.array([s.horizontal_m for s in scores])),
    )


def _ratios(summaries: Sequence[OutageSummary]) -> dict[str, Figures]:
    by_kind = {(s.filter, s.duration_s): s.horizontal_m for s in summaries}
    ratios = {
        f"{duration_s:g}": ratio_of(figures, by_kind.get(("yardstick", duration_s)))
        for (name, duration_s), figures in by_kind.items()
        if name == "fusion"
    }
    return {duration: ratio for duration, ratio in ratios.items() if ratio is not None}


def _percent(error_m: float, distance_m: float) -> float | None:
    return 100.0 * error_m / distance_m if distance_m >= SHORTEST_M else None
