"""Pure: when a sensor on the bus samples, and when its frames come."""

import numpy as np

from wayline_simulator.journey import MOTION_STEP_S, Floats, Motion


def instants(duration_s: float, rate_hz: float, random: np.random.Generator) -> Floats:
    """An even grid over a drive; the sensor's clock began whenever it did. Shape (n,)."""
    phase_s = random.uniform(0.0, 1.0 / rate_hz)
    count = int((duration_s - phase_s) * rate_hz) + 1
    return phase_s + np.arange(max(count, 0)) / rate_hz


def frame_times(grid_s: Floats, jitter_s: float, random: np.random.Generator) -> Floats:
    """When the frames of a grid come; a late one holds up its successors, as on a bus."""
    times_s = grid_s + jitter_s * random.standard_normal(len(grid_s))
    return np.maximum.accumulate(np.maximum(times_s, 0.0))


def motion_steps(motion: Motion, times_s: Floats) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """The sample of a motion that holds at an instant, for what is constant in between."""
    steps = np.floor(times_s / MOTION_STEP_S + 1e-9).astype(np.intp)
    return np.clip(steps, 0, len(motion.times_s) - 1)
