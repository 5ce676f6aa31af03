"""Pure: what was seen on one drive of a scenario."""

from dataclasses import dataclass

from wayline_evaluation.outages import OutageScore
from wayline_evaluation.pose_errors import PoseErrors
from wayline_evaluation.scenario_plan import StudyDrive

Bars = dict[str, float | None]
"""By name; None where the drive had no occasion."""


@dataclass(frozen=True, slots=True)
class Studied:
    """What was seen on one drive."""

    drive: StudyDrive
    distance_m: float
    errors: dict[str, PoseErrors]
    """By filter: fusion, yardstick."""
    outages: tuple[OutageScore, ...]
    blind: dict[str, PoseErrors]
    """By filter, in those outages; empty where the plan has none."""
    bars: Bars
