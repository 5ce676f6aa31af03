"""What the viewer shows at first: the map and the states on the left, the plots on the right."""

from collections.abc import Mapping, Sequence
from typing import Any

import rerun as rr
import rerun.blueprint as rrb

from wayline.rerun_view.columns import TIMELINE

WINDOW_S = 120.0
"""How much of the past the plots show."""

_START = rrb.TimeRangeBoundary.cursor_relative(seconds=-WINDOW_S)
_END = rrb.TimeRangeBoundary.cursor_relative()
_WINDOW = rrb.VisibleTimeRange(TIMELINE, start=_START, end=_END)
_AXIS = rrb.TimeAxis(view_range=rr.TimeRange(start=_START, end=_END))
_PAST = rrb.VisibleTimeRange(TIMELINE, start=rrb.TimeRangeBoundary.infinite(), end=_END)
TRAILS = ("fixes", "rejected", "rejected_from", "path")
"""Entities that stay on the map; any other entity is there with its latest place only."""
HORIZONTAL = {
    "gyro_bias_degps": "gyro bias, deg/s",
    "gyro_scale": "gyro scale",
    "odometer_scale": "odometer scale",
}
VERTICAL = {
    "baro_bias_m": "barometer bias, m",
    "torque_bias_pct": "torque bias, %",
    "mass_kg": "mass, kg",
}
GPS = {"gps_latency_s": "GPS latency, s"}
NIS_TOP = 30.0
"""Where the plots of NIS end: gates lie at 9 to 18, and a reflected fix's 1,000 would hide them."""


def make_blueprint(zooms: Mapping[str, float]) -> rrb.Blueprint:
    """A page for every vehicle, in tabs where there are several; time follows the newest row.

    `zooms` says by vehicle how near its map begins (0 the world, 16 a few streets).
    """
    pages = [_page(vehicle_id, zooms[vehicle_id]) for vehicle_id in sorted(zooms)]
    return rrb.Blueprint(
        pages[0] if len(pages) == 1 else rrb.Tabs(*pages),
        rrb.TimePanel(timeline=TIMELINE, play_state="following", state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_views=False,
    )


def _page(vehicle_id: str, zoom: float) -> rrb.Container:
    root = f"/{rr.escape_entity_path_part(vehicle_id)}"
    left = rrb.Vertical(
        _map(root, zoom),
        rrb.StateTimelineView(
            origin=f"{root}/states", name="states", time_ranges=_WINDOW, time_view=_AXIS
        ),
        _reasons(root),
        row_shares=[9, 7, 4],
    )
    right = rrb.Vertical(
        _plot(root, "speed", "speed, m/s"),
        rrb.Horizontal(
            _plot(root, "altitude", "altitude, m"),
            _plot(root, "grade", "grade, %", legend=False),
        ),
        _nis(root, "NIS of GPS positions, gate, rejected", ["+ $origin/gps_position/**"]),
        _nis(
            root,
            "NIS of all others",
            ["+ $origin/**", "- $origin/gps_position/**"],
            legend=True,
        ),
        rrb.Tabs(
            _calibration(root, "horizontal sensors", HORIZONTAL),
            _calibration(root, "vertical sensors", VERTICAL),
            _calibration(root, "GPS", GPS),
            _satellites(root),
            active_tab=0,
        ),
    )
    return rrb.Horizontal(left, right, column_shares=[1, 1], name=vehicle_id)


def _satellites(root: str) -> rrb.Container:
    """Where they stand, and by how many stds each one's range and range rate are off."""
    around = rrb.VisualBounds2D(x_range=(-95.0, 95.0), y_range=(-95.0, 95.0))
    return rrb.Horizontal(
        rrb.Spatial2DView(origin=f"{root}/sky", name="sky, north up", visual_bounds=around),
        _plot(root, "gps_raw", "ranges, stds off"),
        _plot(root, "gps_raw_rate", "range rates, stds off", legend=False),
        name="satellites",
    )


def _map(root: str, zoom: float) -> rrb.MapView:
    # Any: Rerun's mapping has keys of two kinds, and a mapping is invariant in its keys
    overrides: dict[Any, rrb.VisibleTimeRanges] = {
        f"{root}/map/{trail}": rrb.VisibleTimeRanges([_PAST]) for trail in TRAILS
    }
    return rrb.MapView(origin=f"{root}/map", name="map", zoom=zoom, overrides=overrides)


def _reasons(root: str) -> rrb.TextLogView:
    columns = rrb.TextLogColumns(timeline_columns=[TIMELINE], text_log_columns=["body"])
    return rrb.TextLogView(origin=f"{root}/reasons", name="why rejected", columns=columns)


def _nis(
    root: str, name: str, contents: Sequence[str], *, legend: bool = False
) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin=f"{root}/innovations",
        contents=contents,
        name=name,
        time_ranges=_WINDOW,
        axis_x=_AXIS,
        axis_y=rrb.ScalarAxis(range=(0.0, NIS_TOP)),
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop, visible=legend),
    )


def _plot(root: str, path: str, name: str, *, legend: bool = True) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin=f"{root}/{path}",
        name=name,
        time_ranges=_WINDOW,
        axis_x=_AXIS,
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop, visible=legend),
    )


def _calibration(root: str, title: str, names: Mapping[str, str]) -> rrb.Container:
    plots = [_plot(root, f"calibration/{path}", name, legend=False) for path, name in names.items()]
    return rrb.Horizontal(*plots, name=title)
