"""Pure: what was seen on all scenarios, as one Markdown table."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from wayline_evaluation.figures import (
    Figures,
    Inside,
    consistency_of,
    errors_of,
    figures_of,
    ratio_of,
)
from wayline_evaluation.outages import OutageScore
from wayline_evaluation.pose_errors import PoseErrors, pooled
from wayline_evaluation.studied import Bars, Studied

HEADER = (
    "scenario",
    "drives, km",
    "horizontal p50/p95, m",
    "heading p95, deg",
    "altitude p95, m",
    "grade p95, %",
    "outages p68/p95, % of distance",
    "position inside 1/2 sigma",
    "heading",
    "position, heading in outages",
    "its own bar",
)


def markdown(studied: Sequence[Studied]) -> Iterator[str]:
    """Lines: a row a scenario, then all of them together; `x` is a multiple of the yardstick's."""
    yield _line(HEADER)
    yield _line(["---"] * len(HEADER))
    rows = sorted(studied, key=lambda each: each.drive.scenario)
    for scenario, group in groupby(rows, key=lambda each: each.drive.scenario):
        yield _row(scenario, list(group))
    told = [each for each in rows if "yardstick" in each.errors]
    if told:
        yield _row("all with a yardstick", [replace(each, bars={}) for each in told])


def yardstick_lines(studied: Sequence[Studied]) -> Iterator[str]:
    """How honest the yardstick itself is, pooled."""
    known = [each.errors["yardstick"] for each in studied if "yardstick" in each.errors]
    if not known:
        return
    errors = pooled(known)
    blind = [each.blind["yardstick"] for each in studied if each.blind]
    parts = {f"with GPS, {len(known)} drives": errors.where(~errors.dead_reckoning)}
    if blind:
        parts[f"in outages, {len(blind)} drives"] = pooled(blind)
    for name, part in parts.items():
        found = consistency_of(part)
        nees = "-" if found.nees_mean is None else f"{found.nees_mean:.2f}"
        yield (
            f"yardstick {name}: NEES {nees} (2), ellipse {_inside(found.ellipse)}, "
            f"heading {_inside(found.heading)}, altitude {_inside(found.alt)}, "
            f"grade {_inside(found.grade)} percent inside (68/95)"
        )


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _row(name: str, group: Sequence[Studied]) -> str:
    ours = pooled([each.errors["fusion"] for each in group])
    told = [each.errors["yardstick"] for each in group if "yardstick" in each.errors]
    possible = pooled(told) if told else None
    consistency = consistency_of(ours)
    return _line(
        [
            name,
            f"{len(group)}, {sum(each.distance_m for each in group) / 1000.0:.0f}",
            _compared(ours, possible, "horizontal_m", ("p50", "p95")),
            _compared(ours, possible, "heading_deg", ("p95",)),
            _compared(ours, possible, "alt_m", ("p95",)),
            _compared(ours, possible, "grade_pct", ("p95",)),
            _outages([score for each in group for score in each.outages]),
            _inside(consistency.ellipse),
            _inside(consistency.heading),
            _in_outages([each.blind["fusion"] for each in group if each.blind]),
            "; ".join(_bars([each.bars for each in group])),
        ]
    )


def _compared(
    ours: PoseErrors, possible: PoseErrors | None, name: str, quantiles: Sequence[str]
) -> str:
    found: Figures | None = getattr(errors_of(ours), name)
    bar: Figures | None = None if possible is None else getattr(errors_of(possible), name)
    return "" if found is None else _multiples(found, bar, quantiles)


def _multiples(found: Figures, bar: Figures | None, names: Sequence[str]) -> str:
    figures = "/".join(f"{getattr(found, name):.2g}" for name in names)
    ratio = ratio_of(found, bar)
    if ratio is None:
        return figures
    return f"{figures} (x{'/'.join(f'{getattr(ratio, name):.1f}' for name in names)})"


def _outages(scores: Sequence[OutageScore]) -> str:
    """Quantiles of the shares, and the mean horizontal error as a multiple."""
    shares: dict[str, list[float]] = {"fusion": [], "yardstick": []}
    means: dict[str, list[float]] = {"fusion": [], "yardstick": []}
    for score in scores:
        means[score.filter].append(score.horizontal_m)
        if score.horizontal_pct is not None:
            shares[score.filter].append(score.horizontal_pct)
    ours, bar = (figures_of(np.array(shares[name])) for name in ("fusion", "yardstick"))
    if ours is None or bar is None:
        return ""
    ratio = float(np.mean(means["fusion"]) / np.mean(means["yardstick"]))
    cell = _multiples(ours, bar, ("p68", "p95"))
    return f"{cell}, mean x{ratio:.1f} of {len(shares['fusion'])}"


def _in_outages(blind: Sequence[PoseErrors]) -> str:
    if not blind:
        return ""
    found = consistency_of(pooled(blind))
    return f"{_inside(found.ellipse)}, {_inside(found.heading)}"


def _inside(inside: Inside | None) -> str:
    return (
        "" if inside is None else f"{100.0 * inside.one_sigma:.0f}/{100.0 * inside.two_sigma:.0f}"
    )


def _bars(found: Sequence[Bars]) -> Iterator[str]:
    """Each by its worst drive."""
    for name in dict.fromkeys(name for each in found for name in each):
        values = [value for each in found if (value := each.get(name)) is not None]
        if values:
            yield f"{name} {max(values, key=abs):.3g}"
