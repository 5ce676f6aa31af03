"""The published route filter as papers/000 shows it in its figures 19 to 21."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wayline.geo import LocalPlane
from wayline_eta.avl_filter import Estimate
from wayline_evaluation.avl import ellipse_of
from wayline_evaluation.avl_study import AvlStudy
from wayline_evaluation.estimates import Floats
from wayline_evaluation.plots import new_figure, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIGMAS = 2.0
MARGIN_M = 25.0
ZOOM_ROWS = 14
"""About a row, of a picture that shows a part."""


def plot_avl(study: AvlStudy, path: Path) -> None:
    """The whole route, a part where fixes come, and one where they do not."""
    figure = new_figure(11.0, 11.0)
    axes = figure.subplot_mosaic([["whole", "whole"], ["with", "without"]], height_ratios=(3, 2))
    gaps = [row for row, sample in enumerate(study.samples) if sample.is_repeat]
    gap = gaps[len(gaps) // 2] if gaps else len(study.samples) // 2
    _draw(axes["whole"], study, range(len(study.samples)), "all rows (figure 19)")
    # fixes are lost every half minute, so midway between two gaps they come
    _draw(axes["with"], study, _around(gap + ZOOM_ROWS, study), "with fixes (figure 20)")
    _draw(axes["without"], study, _around(gap, study), "without fixes for some rows (figure 21)")
    axes["whole"].legend(loc="upper right")
    save_figure(figure, path)


def _around(row: int, study: AvlStudy) -> range:
    return range(max(row - ZOOM_ROWS // 2, 0), min(row + ZOOM_ROWS // 2, len(study.samples)))


def _draw(axes: "Axes", study: AvlStudy, rows: range, title: str) -> None:
    line = study.route.line
    plane = LocalPlane(float(line.lats_deg[0]), float(line.lons_deg[0]))
    road_m = _places_m(plane, zip(line.lats_deg, line.lons_deg, strict=True))
    axes.plot(*road_m, color="0.75", lw=4.0, label="planned route")
    estimates = [study.estimates[row] for row in rows]
    places_m = _places_m(plane, ((each.lat_deg, each.lon_deg) for each in estimates))
    for estimate, place_m in zip(estimates, places_m.T, strict=True):
        axes.plot(*_outline_m(estimate, place_m), color="C0", lw=0.6, alpha=0.7)
    axes.plot(*places_m, ".", color="C0", ms=5.0, label="estimates, ellipses of 2 sigma")
    fixes = [study.samples[row] for row in rows if not study.samples[row].is_repeat]
    fixes_m = _places_m(plane, ((each.lat_deg, each.lon_deg) for each in fixes))
    axes.plot(*fixes_m, "x", color="C3", ms=5.0, label="fixes")
    low_m, high_m = places_m.min(axis=1) - MARGIN_M, places_m.max(axis=1) + MARGIN_M
    axes.set(xlim=(low_m[0], high_m[0]), ylim=(low_m[1], high_m[1]), aspect="equal")
    axes.set(xlabel="east, m", ylabel="north, m")
    axes.set_title(f"{title}, rows {rows.start + 1} to {rows.stop}", loc="left", fontsize=9)


def _places_m(plane: LocalPlane, places_deg: Iterable[tuple[float, float]]) -> Floats:
    """East and north of latitudes and longitudes, shape (2, n)."""
    return np.array([plane.to_plane(*place) for place in places_deg]).reshape(-1, 2).T


def _outline_m(estimate: Estimate, place_m: Floats) -> Floats:
    """The ellipse of two standard deviations, shape (2, n)."""
    ellipse = ellipse_of(estimate)
    turns = np.linspace(0.0, 2.0 * np.pi, 41)
    heading = np.radians(ellipse.heading_deg)
    along = np.array([np.sin(heading), np.cos(heading)])
    across = np.array([np.cos(heading), -np.sin(heading)])
    around = np.outer(along, ellipse.major_m * np.cos(turns)) + np.outer(
        across, ellipse.minor_m * np.sin(turns)
    )
    return np.asarray(place_m[:, None] + SIGMAS * around)
