"""Pure: when a receiver is blind, and how it comes back."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline_simulator.gps_errors import decays, drawn_at
from wayline_simulator.gps_events import DisplacedFixes, Outage
from wayline_simulator.journey import Floats

Flags = NDArray[np.bool_]

FORGETTING_S = 10.0
"""After a blindness of this length a receiver begins nearly anew; a bridge leaves its filter and
its loops as they are. A judgement."""


class Awakenings(NamedTuple):
    """First fixes after blindness."""

    epochs: NDArray[np.intp]
    severity: Floats
    """0 to 1, by the length of the blindness."""


def scheduled(times_s: Floats, event: Outage | DisplacedFixes) -> Flags:
    """Whether an event lasts at these seconds from the start of the drive."""
    since_s = times_s - event.start_s
    if event.every_s is not None:
        return (since_s >= 0.0) & (since_s % event.every_s < event.length_s)
    return (since_s >= 0.0) & (since_s < event.length_s)


def lengthened(blind: Flags, step_s: float, mean_s: float, random: np.random.Generator) -> Flags:
    """Blindness until satellites are found again, an exponentially distributed time later."""
    result = blind.copy()
    for end in np.flatnonzero(blind[:-1] & ~blind[1:]) + 1:
        result[end : end + round(random.exponential(mean_s) / step_s)] = True
    return result


def awakenings(valid: Flags, step_s: float) -> Awakenings:
    """Where fixes begin again; the first of all, if the drive did not begin with it, is none."""
    begins = np.flatnonzero(valid[1:] & ~valid[:-1]) + 1
    last_valid = np.maximum.accumulate(np.where(valid, np.arange(len(valid)), -1))[begins - 1]
    begins, last_valid = begins[last_valid >= 0], last_valid[last_valid >= 0]
    blind_s = (begins - last_valid) * step_s
    return Awakenings(begins, -np.expm1(-blind_s / FORGETTING_S))


def errors_after(
    woken: Awakenings, count: int, step_s: float, time_s: float, random: np.random.Generator
) -> tuple[Floats, Floats]:
    """Std, shape (count,), and error, shape (count, 3), where the first fixes err by std 1."""
    severity = np.append(0.0, woken.severity)
    which = np.searchsorted(woken.epochs, np.arange(count), side="right")
    std = severity[which] * decays(woken.epochs, count, step_s, time_s)
    return std, std[:, np.newaxis] * drawn_at(woken.epochs, count, random)
