"""Pure: a road along the line of a file, with its speeds and stops or with made up ones."""

import numpy as np

from wayline.line import Line
from wayline_simulator.closing import Start
from wayline_simulator.country_road import KMH, MAIN
from wayline_simulator.course import STEP_M, Floats, Halt
from wayline_simulator.line_course import LineFile, LinePoints, SmoothLine, smooth_line
from wayline_simulator.road_plan import RoadPlan, bare_plan
from wayline_simulator.vertical_alignment import close_grade, rolling_grade

DEFAULT_LIMIT_MPS = 50.0 * KMH
STEEPEST = 0.15
"""Steeper than any road but a ramp: an altitude's error."""


def plan_along(
    where: str,
    line: LineFile,
    start: Start,
    limit_mps: float | None,
    random: np.random.Generator,
    *,
    loop: bool,
) -> tuple[RoadPlan, Start]:
    """The plan of a file's road and where it begins; `start` gives the altitude if it has none.

    Raises InputError, naming `where`, for a line that cannot be driven.
    """
    smooth = smooth_line(where, line.points, loop=loop)
    grade = _grade(smooth, random, loop=loop)
    plan = bare_plan(smooth.curvature_per_m, grade, limit_mps or DEFAULT_LIMIT_MPS, loop=loop)
    if line.points.speeds_mps is not None and limit_mps is None:
        plan.limits_mps[:] = _limits_mps(line.points, line.points.speeds_mps, smooth.source_m)
    for stop in line.stops:
        at = int(np.searchsorted(smooth.source_m, stop.distance_m))
        plan.halts.append(Halt(at * STEP_M, "stop", stop.dwell_s, stop.name))
    alt_m = start.alt_m if smooth.grade is None else smooth.start.alt_m
    return plan, smooth.start._replace(alt_m=alt_m)


def _limits_mps(points: LinePoints, speeds_mps: Floats, source_m: Floats) -> Floats:
    """The planned speed of the leg that every sample is from; a closing leg has the last one's."""
    ends_m = Line(points.lats_deg, points.lons_deg).distances_m[1:-1]
    return speeds_mps[np.searchsorted(ends_m, source_m, side="right")]


def _grade(smooth: SmoothLine, random: np.random.Generator, *, loop: bool) -> Floats:
    if smooth.grade is None:
        return rolling_grade(len(smooth.curvature_per_m), MAIN.relief, random, loop=loop)
    grade = np.clip(smooth.grade, -STEEPEST, STEEPEST)
    return close_grade(grade, STEEPEST) if loop else grade
