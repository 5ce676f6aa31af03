"""What fusion makes of a trip that has GPS alone: its poses at the fixes."""

from pathlib import Path

import numpy as np

from wayline.drive_file import load_drive
from wayline.messages import Pose
from wayline.pipeline import Pipeline
from wayline.replayed_drive import ReplayedDrive
from wayline_evaluation.estimates import estimates_of
from wayline_evaluation.smoothing.smoothers import Made
from wayline_evaluation.smoothing.trip import Trip
from wayline_replay.parts import nodes

SERVICE = "fusion"


def by_fusion(folder: Path, trip: Trip) -> Made:
    """Fusion fed with the trip's fixes and nothing else, as in live."""
    drive = load_drive(folder)
    poses: list[Pose] = []
    fusion = [node for node in nodes(ReplayedDrive(drive, (), None)) if node.name == SERVICE]
    pipeline = Pipeline(
        fusion, lambda message, _: poses.append(message) if isinstance(message, Pose) else None
    )
    for fix in trip.fixes:
        pipeline.feed(fix, "gps-ingest")
    pipeline.finish()
    estimates = estimates_of(poses).at(np.array([fix.t_ns for fix in trip.fixes]) * 1e-9)
    speeds_mps = np.abs(estimates.speeds_mps)
    known_m = estimates.distances_m[~np.isnan(estimates.distances_m)]
    steps_m = 0.5 * (speeds_mps[1:] + speeds_mps[:-1]) * trip.track.steps_s
    return Made(speeds_mps, float(known_m[-1] - known_m[0]), float(np.nansum(steps_m)))
