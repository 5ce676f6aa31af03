"""Runs fusion and the slope map's smoothing over one drive, with all its sensors or with one."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np

from wayline.core import Record
from wayline.drive import Drive
from wayline.errors import InputError
from wayline.messages import FusionStatus, Message, Pose
from wayline.node import Node
from wayline.pipeline import Pipeline
from wayline.recording import JsonLines
from wayline.replayed_drive import ReplayedDrive
from wayline.tuning import VerticalSensor
from wayline_evaluation.estimates import Estimates, Floats, estimates_of
from wayline_evaluation.slope import Grades
from wayline_fusion.replayed import node as fusion_node
from wayline_replay.stream import DriveStream
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.records import DrivenRun, Sensor
from wayline_slope_map.run import smoothed_by_sensor
from wayline_slope_map.track import Track

ALL: tuple[Sensor, ...] = ("fused",)
Told = Sequence[tuple[Message, str]]
"""What a drive's sensors said, with the sources, in order of arrival."""


class Driven(NamedTuple):
    """What came of a drive."""

    estimates: Estimates
    statuses: tuple[FusionStatus, ...]
    tracks: tuple[Track, ...]
    """Of its runs, which a long stand or a silence parts."""


class _Collected:
    """A store that only hands back what a core wanted kept."""

    def __init__(self) -> None:
        self.runs: list[DrivenRun] = []

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        if isinstance(record, DrivenRun):
            self.runs.append(record)
        return ()


def told_by(drive: Drive, where: Path) -> Told:
    """Read a drive. Raises InputError."""
    stream = DriveStream(drive, str(where))
    return [(arrival.message, arrival.source) for arrival in stream]


def driven(drive: Drive, told: Told, keep: Path | None = None) -> Driven:
    """Fusion's poses and the map's tracks; topics are written to `keep`. Raises InputError."""
    collected = _Collected()
    core = SlopeMapCore(KnownRoads(), drive.tuning, drive.drive.vehicle_id, drive.vehicle)
    nodes = [fusion_node(ReplayedDrive(drive, (), None)), Node("slope-map", core, collected)]
    said = list(_published(drive, nodes, told, keep))
    return Driven(
        _estimates(said, drive),
        tuple(message for message in said if isinstance(message, FusionStatus)),
        tuple(run.track for run in collected.runs),
    )


def driven_by(drive: Drive, told: Told, sensor: VerticalSensor) -> Estimates:
    """Fusion's poses where one sensor alone tells of the slope. Raises InputError."""
    tuning = msgspec.structs.replace(drive.tuning, vertical_sensors=(sensor,))
    alone = msgspec.structs.replace(drive, tuning=tuning)
    node = fusion_node(ReplayedDrive(alone, (), None))
    return _estimates(list(_published(alone, [node], told, None)), drive)


def map_grades(driven: Driven, drive: Drive, bin_m: float) -> dict[Sensor, Grades]:
    """What the map learns of a drive by each of its sensors and all, at every bin's centre."""
    parts: dict[Sensor, list[tuple[Floats, Floats, Floats]]] = {}
    for track in driven.tracks:
        centres_m = _centres_m(track, bin_m)
        times_s = track.start_ns * 1e-9 + track.seconds_at(centres_m)
        for sensor, found in smoothed_by_sensor(track, centres_m, drive.tuning).items():
            columns = (times_s, found.grade_pct, found.grade_std_pct)
            parts.setdefault(sensor, []).append(columns)
    return {sensor: _joined(runs) for sensor, runs in parts.items()}


def read_every_metre(driven: Driven, drive: Drive, bin_m: float) -> tuple[Floats, Floats]:
    """Instants (Unix) a metre of the way apart, and the grade that bins of this length say there.

    A bin says its centre's grade over all of its length.
    """
    times_s, grades_pct = [np.empty(0)], [np.empty(0)]
    for track in driven.tracks:
        centres_m, metres_m = _centres_m(track, bin_m), _centres_m(track, 1.0)
        found = smoothed_by_sensor(track, centres_m, drive.tuning, ALL).get("fused")
        if found is None:
            continue
        rows = ((metres_m - track.travelled_m[0]) // bin_m).astype(np.intp)
        told = rows < len(centres_m)
        times_s.append(track.start_ns * 1e-9 + track.seconds_at(metres_m[told]))
        grades_pct.append(found.grade_pct[rows[told]])
    return np.concatenate(times_s), np.concatenate(grades_pct)


def _joined(runs: Sequence[tuple[Floats, Floats, Floats]]) -> Grades:
    times_s, grades_pct, stds_pct = (np.concatenate(each) for each in zip(*runs, strict=True))
    return Grades(times_s, grades_pct, stds_pct=stds_pct)


def _centres_m(track: Track, bin_m: float) -> Floats:
    """Distances travelled at the middles of the bins that a track's way is cut into."""
    return np.arange(track.travelled_m[0] + 0.5 * bin_m, track.travelled_m[-1], bin_m)


def _published(
    drive: Drive, nodes: Sequence[Node], told: Told, keep: Path | None
) -> Iterator[Message]:
    said: list[Message] = []
    if keep is None:
        _feed(Pipeline(nodes, lambda message, _: said.append(message)), told)
    else:
        with JsonLines(keep, drive.drive.vehicle_id) as lines:

            def publish(message: Message, source: str) -> None:
                said.append(message)
                lines.write(message, source)

            _feed(Pipeline(nodes, publish), told)
    return (message for message in said if isinstance(message, Pose | FusionStatus))


def _feed(pipeline: Pipeline, told: Told) -> None:
    for message, source in told:
        pipeline.feed(message, source)
    pipeline.finish()


def _estimates(said: Sequence[Message], drive: Drive) -> Estimates:
    poses = [message for message in said if isinstance(message, Pose)]
    if not poses:
        where = drive.drive.vehicle_id
        raise InputError(where, "its replay has no pose", "name a drive with GPS or CAN")
    return estimates_of(poses)
