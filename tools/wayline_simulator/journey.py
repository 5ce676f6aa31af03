"""Pure: how a vehicle moved along a course, and the truth of it at any instant."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline_simulator.course import STEP_M, Course

Floats = NDArray[np.float64]

MOTION_STEP_S = 0.05
"""Between the samples of a motion; acceleration is constant within a step."""


@dataclass(frozen=True, slots=True)
class Motion:
    """A vehicle's motion and drive train, MOTION_STEP_S apart from 0 s, shape (n,) each."""

    times_s: Floats
    path_m: Floats
    """Horizontal distance along the course; never decreases, in reverse neither."""
    speeds_mps: Floats
    """Along the road's surface, >= 0 in the direction of travel."""
    wheel_radps: Floats
    """Turning rate of the driven wheels, slip included."""
    engine_torque_nm: Floats
    """Net at the crankshaft, from here to the next sample."""
    engine_speed_rpm: Floats
    gear: NDArray[np.int8]
    """0 neutral, -1 reverse."""
    gear_ratio: Floats
    """Of the gearbox, nan in neutral."""
    brake: NDArray[np.bool_]
    clutch: NDArray[np.bool_]
    """True: the driveline is open."""
    drive_force_n: Floats
    """Driving force at the tyres' contact, from here to the next sample."""
    brake_force_n: Floats
    """>= 0, against the motion."""
    resistance_n: Floats
    """Rolling and air, against the motion."""


class Truth(NamedTuple):
    """The vehicle at instants, shape (n,) each."""

    times_s: Floats
    path_m: Floats
    lats_deg: Floats
    lons_deg: Floats
    alts_m: Floats
    courses_deg: Floats
    """Direction of travel, true, 0 <= x < 360."""
    headings_deg: Floats
    """Of the nose."""
    speeds_mps: Floats
    """Over ground (horizontal), negative in reverse."""
    yaw_rates_degps: Floats
    """Positive turning right."""
    grades_pct: Floats
    """In the direction of travel."""
    surroundings: NDArray[np.int8]


@dataclass(frozen=True, slots=True)
class Journey:
    """A motion along a course."""

    course: Course
    motion: Motion

    @property
    def duration_s(self) -> float:
        """Time of the last sample."""
        return float(self.motion.times_s[-1])

    def at(self, times_s: Floats) -> Truth:
        """The truth at instants in any order; the vehicle stands before the first and the last."""
        path_m, surface_mps, level_share = self._moved(times_s)
        course = self.course
        place = path_m / STEP_M
        before = np.clip(place.astype(np.intp), 0, len(course.distances_m) - 2)
        share = place - before

        def between(values: Floats) -> Floats:
            return values[before] + share * (values[before + 1] - values[before])

        ground_mps = surface_mps * level_share
        backwards = course.backwards[before]
        signs = np.where(backwards, -1.0, 1.0)
        headings_deg = np.degrees(between(course.headings_rad)) % 360.0
        return Truth(
            times_s=times_s,
            path_m=path_m,
            lats_deg=between(course.lats_deg),
            lons_deg=between(course.lons_deg),
            alts_m=between(course.alts_m),
            courses_deg=np.where(backwards, (headings_deg + 180.0) % 360.0, headings_deg),
            headings_deg=headings_deg,
            speeds_mps=signs * ground_mps,
            yaw_rates_degps=np.degrees(between(course.curvature_per_m) * ground_mps),
            grades_pct=100.0 * signs * between(course.grade),
            surroundings=course.surroundings[before],
        )

    def _moved(self, times_s: Floats) -> tuple[Floats, Floats, Floats]:
        """Path, speed along the surface, and its horizontal share at instants."""
        motion = self.motion
        clipped = np.clip(times_s, 0.0, self.duration_s)
        step = np.minimum((clipped / MOTION_STEP_S).astype(np.intp), len(motion.times_s) - 2)
        since_s = clipped - motion.times_s[step]
        first_mps, last_mps = motion.speeds_mps[step], motion.speeds_mps[step + 1]
        speeds_mps = first_mps + (last_mps - first_mps) * (since_s / MOTION_STEP_S)
        gone_m = (first_mps + speeds_mps) / 2.0 * since_s
        whole_m = (first_mps + last_mps) / 2.0 * MOTION_STEP_S
        level_m = motion.path_m[step + 1] - motion.path_m[step]
        level_share = np.divide(level_m, whole_m, out=np.ones_like(whole_m), where=whole_m > 0.0)
        outside = (times_s < 0.0) | (times_s > self.duration_s)
        return (
            motion.path_m[step] + gone_m * level_share,
            np.where(outside, 0.0, speeds_mps),
            level_share,
        )
