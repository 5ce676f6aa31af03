"""Pure: what the sensors hand on to the files: lines of text and frames, with their instants."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline_simulator.journey import Floats


class TimedLine(NamedTuple):
    """A line of text, without its end, and when it arrived in Unix seconds."""

    arrival_s: float
    text: bytes


class Frames(NamedTuple):
    """All frames of one CAN id, in order of time."""

    frame_id: int
    times_s: Floats
    """When each arrived, in seconds from the drive's start. Shape (n,)."""
    data: NDArray[np.uint8]
    """Shape (n, bytes)."""
