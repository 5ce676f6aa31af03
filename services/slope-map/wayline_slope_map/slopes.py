"""Pure: the slopes that a run's engine has told, ready to be smoothed."""

import math
from bisect import bisect_left
from typing import NamedTuple

import numpy as np

from wayline.line import Floats
from wayline.tuning import Tuning
from wayline.vertical.propulsion import Push
from wayline_slope_map.track import Track

BESIDE_NS = 5_000_000_000
"""The vehicle makes its slope of the same torque: one within so long of a torque is left out."""


class Window(NamedTuple):
    """What a torque's window has besides; the words are those of `Push`."""

    length_s: float
    level: float
    speed_std_mps: float
    goes_on: bool
    is_braked: bool


class Slopes(NamedTuple):
    """Means of short windows, shape (n,) each, at the windows' middles, in order of time."""

    times_s: Floats
    travelled_m: Floats
    share: Floats
    """Of a torque the engine's force over the stated weight, else tan of the slope angle."""
    std: Floats
    windows: tuple[Window | None, ...]
    """Of torques; None where the vehicle itself tells the slope."""


NO_SLOPES = Slopes(*(np.empty(0),) * 4, ())


class _Row(NamedTuple):
    t_ns: int
    share: float
    std: float
    window: Window | None


def run_slopes(track: Track, tuning: Tuning) -> dict[str, Slopes]:
    """By torque, by the vehicle's own slope, and by the two where they do not tell the same."""
    torque, vehicle = _torque_rows(track, tuning), _vehicle_rows(track, tuning)
    alone = _without_echo(vehicle, [row.t_ns for row in torque])
    return {
        "torque": _slopes(track, torque),
        "vehicle": _slopes(track, vehicle),
        "both": _slopes(track, sorted(torque + alone, key=lambda row: row.t_ns)),
    }


def _torque_rows(track: Track, tuning: Tuning) -> list[_Row]:
    white = tuning.torque_std_pct / 100.0
    return [
        _Row(
            push.middle_ns,
            push.share,
            math.hypot(white / math.sqrt(push.length_s), push.sampling_std),
            _window(push),
        )
        for push in track.pushes
    ]


def _window(push: Push) -> Window:
    return Window(
        push.length_s,
        push.level,
        push.speed_std_mps,
        push.goes_on,
        push.is_braked,
    )


def _vehicle_rows(track: Track, tuning: Tuning) -> list[_Row]:
    white = tuning.vehicle_slope_std_pct / 100.0
    return [
        _Row(report.middle_ns, report.slope, white / math.sqrt(report.length_s), None)
        for report in track.own_slopes
    ]


def _without_echo(vehicle: list[_Row], torques_ns: list[int]) -> list[_Row]:
    """The vehicle's own slopes where no torque near by tells as much."""

    def is_alone(row: _Row) -> bool:
        at = bisect_left(torques_ns, row.t_ns)
        return all(abs(t_ns - row.t_ns) > BESIDE_NS for t_ns in torques_ns[max(at - 1, 0) : at + 1])

    return [row for row in vehicle if is_alone(row)]


def _slopes(track: Track, rows: list[_Row]) -> Slopes:
    last_ns = track.times_ns[-1]
    within = [row for row in rows if track.start_ns <= row.t_ns <= last_ns]
    times_s = track.seconds([row.t_ns for row in within])
    return Slopes(
        times_s,
        track.travelled_at(times_s),
        np.array([row.share for row in within], dtype=np.float64),
        np.array([row.std for row in within], dtype=np.float64),
        tuple(row.window for row in within),
    )
