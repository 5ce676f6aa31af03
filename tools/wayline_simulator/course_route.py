"""Pure: a course as the planned route that the arrival service follows."""

import re

import numpy as np
from numpy.typing import NDArray

from wayline.line import Line
from wayline.route import Route
from wayline.stops import Stop
from wayline_simulator.course import STEP_M, Course

LONGEST_LEG_M = 10.0
LARGEST_TURN_RAD = 0.1
"""Of the line at a vertex: an arc of 8 m radius is then 1 cm from its chords."""


def route_of(course: Course, route_id: str, name: str) -> Route:
    """One lap as a route: its limits are the planned speeds, its stops the course's."""
    kept = _vertices(course)
    lats_deg, lons_deg = course.lats_deg[kept].copy(), course.lons_deg[kept].copy()
    if course.loop:
        # both ends are one place to the last digit, as a loop's must be
        lats_deg[-1], lons_deg[-1] = lats_deg[0], lons_deg[0]
    line = Line(lats_deg, lons_deg)
    return Route(
        route_id=route_id,
        name=name,
        loop=course.loop,
        line=line,
        speeds_mps=course.limits_mps[kept[:-1]],
        stops=_stops(course, np.interp(course.distances_m, kept * STEP_M, line.distances_m)),
    )


def _vertices(course: Course) -> NDArray[np.intp]:
    """Samples that are a leg apart, or less in a bend; where it reverses or a limit begins too."""
    turned_rad = np.concatenate(
        ([0.0], np.cumsum(np.abs(np.diff(course.headings_rad)) / LARGEST_TURN_RAD))
    )
    legs = np.floor(course.distances_m / LONGEST_LEG_M + turned_rad)
    changes = np.diff(course.limits_mps, prepend=course.limits_mps[0]) != 0.0
    changes |= np.diff(course.backwards, prepend=course.backwards[0])
    begins = (np.diff(legs, prepend=-1.0) > 0.0) | changes
    begins[-1] = True
    return np.flatnonzero(begins)


def _stops(course: Course, along_m: NDArray[np.float64]) -> tuple[Stop, ...]:
    """The course's stops where they lie along the line; an id twice gets a number."""
    stops: list[Stop] = []
    for halt in course.halts:
        if halt.kind != "stop":
            continue
        at = round(halt.distance_m / STEP_M)
        stop_id = re.sub(r"\W+", "-", halt.name.lower()).strip("-") or "stop"
        if any(stop.stop_id == stop_id for stop in stops):
            stop_id = f"{stop_id}-{len(stops) + 1}"
        place = float(course.lats_deg[at]), float(course.lons_deg[at])
        name = halt.name or stop_id
        stops.append(Stop(stop_id, name, *place, halt.dwell_s, float(along_m[at])))
    return tuple(stops)
