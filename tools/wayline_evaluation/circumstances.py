"""Pure: what a simulated receiver suffered at each of its fixes, as the yardstick is told."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline_evaluation.estimates import Floats
from wayline_simulator.gps_errors import lagged
from wayline_simulator.gps_measured import EDGE_TIME_S, EFFECTS, Effects
from wayline_simulator.happenings import Happenings, Span

LAG_STEP_S = 0.1
"""The receiver's slow change to new surroundings is followed in such steps."""

ROUNDING_S = 1e-3
"""A fix on a span's very edge belongs to what begins there, whatever doubles make of it."""


class Circumstances(NamedTuple):
    """Of one fix."""

    effects: Effects
    displaced: bool
    blind_s: float
    """How long the receiver had no fix before this one; 0 in a row of fixes."""


def circumstances(
    described_s: Floats, stamped_s: Floats, blind_s: Floats, happened: Happenings
) -> list[Circumstances]:
    """Of fixes by the true instants that they describe and by their timestamps, Unix, (n,) each."""
    moved = within(stamped_s + ROUNDING_S, happened.displaced)
    return [
        Circumstances(Effects(*(float(value) for value in row)), bool(displaced), float(blind))
        for row, displaced, blind in zip(
            _effects(described_s, happened), moved, blind_s, strict=True
        )
    ]


def within(times_s: Floats, spans: Sequence[Span]) -> NDArray[np.bool_]:
    """Which instants lie in one of the spans, their ends excluded."""
    inside = np.zeros(len(times_s), dtype=np.bool_)
    for start_s, end_s in spans:
        inside |= (times_s >= start_s) & (times_s < end_s)
    return inside


def _effects(times_s: Floats, happened: Happenings) -> Floats:
    """Shape (n, 3); open sky where nothing is known."""
    if not happened.surroundings or not len(times_s):
        return np.tile(EFFECTS[0], (len(times_s), 1))
    begins_s = np.array([change.time_s for change in happened.surroundings])
    kinds = np.array([change.surroundings for change in happened.surroundings])
    first_s = min(float(begins_s[0]), float(times_s.min()))
    count = int((float(times_s.max()) - first_s) / LAG_STEP_S) + 2
    grid_s = first_s + LAG_STEP_S * np.arange(count)
    rows = np.clip(np.searchsorted(begins_s, grid_s, "right") - 1, 0, None)
    smooth = lagged(EFFECTS[kinds[rows]], LAG_STEP_S, EDGE_TIME_S)
    return smooth[np.round((times_s - first_s) / LAG_STEP_S).astype(np.intp)]
