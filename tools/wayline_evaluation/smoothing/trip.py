"""Pure: one trip as the study takes it: what GPS told, and what it is judged by."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from wayline.messages import GpsFix
from wayline.trip_distance.track import Track
from wayline_evaluation.estimates import Floats

ReferenceKind = Literal["truth", "wheels", "receiver"]


@dataclass(frozen=True, slots=True)
class Reference:
    """Of one trip; nan where unknown.

    `truth` is a simulation's, `wheels` are a vehicle's scaled by its GPS, `receiver` is the speed
    that the receiver told, which is what is smoothed, too.
    """

    kind: ReferenceKind
    speeds_mps: Floats
    """At the fixes, shape (n,)."""
    distance_m: float
    """From the first fix to the last."""


@dataclass(frozen=True, slots=True)
class Trip:
    """Valid fixes of one trip, at least ten, at times that increase."""

    name: str
    fixes: tuple[GpsFix, ...]
    track: Track
    reference: Reference

    @property
    def told_mps(self) -> Floats:
        """Speeds to smooth, shape (n,): told, or where a receiver tells none, by positions."""
        by_positions = self.track.chords_m / self.track.steps_s
        by_positions = np.concatenate((by_positions[:1], by_positions))
        return np.where(np.isnan(self.track.speeds_mps), by_positions, self.track.speeds_mps)


def added_up(places_m: Floats) -> float:
    """The way over places, shape (n, 2), in straight lines."""
    return float(np.linalg.norm(np.diff(places_m, axis=0), axis=1).sum())
