"""Reads the trips of the study: a drive's fixes, and what its smoothed speeds are judged by."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from wayline.drive import Drive
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.messages import GpsFix, Message, Odometer
from wayline.trip_distance.speeds import unit_doubt
from wayline.trip_distance.track import Track, track_of
from wayline.trip_distance.wheels import Wheels
from wayline_evaluation.estimates import Floats
from wayline_evaluation.replays import drive_name
from wayline_evaluation.smoothing.trip import Reference, Trip
from wayline_evaluation.truth import read_truth
from wayline_replay.stream import DriveStream

FIXES_MIN = 10
"""A shorter trip has nothing to smooth."""
HOLE_S = 1.5
"""Over a longer step the receiver's own speeds tell no way; a straight line does."""
WHEELS_SHARE_MIN = 0.5
"""Of the fixes: with fewer, wheels are no reference."""


class ReadTrip(NamedTuple):
    """A trip, or why there is none, and what a user should know of its input."""

    name: str
    trip: Trip | None
    notes: tuple[str, ...]


class Read(NamedTuple):
    """What a drive's recordings say of its trip."""

    drive: Drive
    fixes: tuple[GpsFix, ...]
    """Valid, of the first receiver, at times that increase."""
    wheels: tuple[Odometer, ...]
    notes: tuple[str, ...]
    """What was dropped or left out."""


def read_drive(folder: Path) -> Read:
    """The fixes and wheels of a drive. Raises InputError where nothing of it can be read."""
    drive = load_drive(folder)
    stream = DriveStream(drive, str(folder))
    gathered = Gathered()
    for received in stream:
        gathered.take(received.message, received.source)
    dropped = sum(stream.bad_input.values())
    notes = [f"{dropped:,} inputs were dropped or mended"] if dropped else []
    if gathered.late:
        notes.append(f"{gathered.late:,} fixes whose time went back were left out")
    return Read(drive, tuple(gathered.fixes), tuple(gathered.wheels), tuple(notes))


def read_trip(folder: Path) -> ReadTrip:
    """A drive as a trip. Raises InputError where nothing of it can be read."""
    name, (drive, fixes, wheels, dropped) = drive_name(folder), read_drive(folder)
    notes = list(dropped)
    if len(fixes) < FIXES_MIN:
        notes.append(f"left out: {len(fixes)} fixes are too few to smooth, {FIXES_MIN} are needed")
        return ReadTrip(name, None, tuple(notes))
    track = track_of(fixes, drive.tuning)
    if doubt := unit_doubt(track):
        mend = f'give speed_mps = {{ name = "...", scale = {doubt.scale:.6g} }}'
        notes.append(f"left out: {doubt}; {mend}")
        return ReadTrip(name, None, tuple(notes))
    if not track.good.any():
        notes.append("no fix is good: fewer than 4 satellites or a PDOP above 8 throughout")
    reference = reference_of(drive, fixes, track, wheels)
    return ReadTrip(name, Trip(name, fixes, track, reference), tuple(notes))


class Gathered:
    """The fixes of a drive's first receiver, and its wheels."""

    def __init__(self) -> None:
        self.fixes: list[GpsFix] = []
        self.wheels: list[Odometer] = []
        self.late = 0
        self._source: str | None = None

    def take(self, message: Message, source: str) -> None:
        """Any message; the others are not listened to."""
        if isinstance(message, Odometer):
            self.wheels.append(message)
        if not isinstance(message, GpsFix) or not message.valid:
            return
        self._source = self._source or source
        if source != self._source:
            return
        if self.fixes and message.t_ns <= self.fixes[-1].t_ns:
            self.late += 1
            return
        self.fixes.append(message)


def reference_of(
    drive: Drive, fixes: tuple[GpsFix, ...], track: Track, wheels: tuple[Odometer, ...]
) -> Reference:
    """What a trip is judged by: its truth, its wheels, or what the receiver says of its speed."""
    if drive.truth is not None:
        return _by_truth(Path(drive.truth.path), fixes)
    return _by_wheels(fixes, track, wheels) or _by_receiver(track)


def _by_truth(path: Path, fixes: tuple[GpsFix, ...]) -> Reference:
    truth = read_truth(path).at(np.array([fix.t_ns for fix in fixes]) * 1e-9)
    known_m = truth.distances_m[~np.isnan(truth.distances_m)]
    if len(known_m) < 2:
        mend = "give the times of the drive in Unix seconds"
        raise InputError(str(path), "tells nothing of the times of the fixes", mend)
    return Reference("truth", np.abs(truth.speeds_mps), float(known_m[-1] - known_m[0]))


def _by_wheels(
    fixes: tuple[GpsFix, ...], track: Track, odometer: tuple[Odometer, ...]
) -> Reference | None:
    """Wheels, of the scale that the receiver's speeds tell; None where they are silent too long."""
    wheels = Wheels()
    for message in odometer:
        wheels.take(message)
    if not wheels.are_told:
        return None
    steps = wheels.steps([fix.t_ns for fix in fixes])
    if np.mean(steps.told) < WHEELS_SHARE_MIN:
        return None
    by_receiver_m = _receiver_steps_m(track)
    compared = steps.told & (track.steps_s <= HOLE_S) & (steps.ways_m > 0.0)
    compared &= ~np.isnan(by_receiver_m)
    rolled_m = float(steps.ways_m[compared].sum())
    scale = float(by_receiver_m[compared].sum()) / rolled_m if rolled_m > 0.0 else 1.0
    ways_m = np.where(steps.told, scale * steps.ways_m, track.chords_m)
    speeds_mps = scale * _speeds_at(fixes, odometer)
    speeds_mps[1:][~steps.told] = np.nan
    return Reference("wheels", speeds_mps, float(ways_m.sum()))


def _speeds_at(fixes: tuple[GpsFix, ...], odometer: tuple[Odometer, ...]) -> Floats:
    """Of the wheels, nan where only a distance was counted."""
    origin_ns = fixes[0].t_ns
    told = [message for message in odometer if message.speed_mps is not None]
    if not told:
        return np.full(len(fixes), np.nan)
    times_s = np.array([(message.t_ns - origin_ns) * 1e-9 for message in told])
    speeds_mps = np.array([message.speed_mps for message in told], dtype=np.float64)
    asked_s = np.array([(fix.t_ns - origin_ns) * 1e-9 for fix in fixes])
    return np.asarray(np.interp(asked_s, times_s, speeds_mps, left=np.nan, right=np.nan))


def _by_receiver(track: Track) -> Reference:
    steps_m = _receiver_steps_m(track)
    ways_m = np.where((track.steps_s <= HOLE_S) & ~np.isnan(steps_m), steps_m, track.chords_m)
    return Reference("receiver", track.speeds_mps, float(ways_m.sum()))


def _receiver_steps_m(track: Track) -> Floats:
    steps_m: Floats = 0.5 * (track.speeds_mps[1:] + track.speeds_mps[:-1]) * track.steps_s
    return steps_m
