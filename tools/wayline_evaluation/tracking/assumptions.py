"""Pure: everything that the study takes for granted, in words."""

from wayline_evaluation.tracking.acquisition import SIGMAS, SearchModel
from wayline_evaluation.tracking.aid import AidModel
from wayline_evaluation.tracking.loop import LOST_HZ, PAIR_S
from wayline_evaluation.tracking.motion import MotionModel


def assumptions(
    motion: MotionModel, aid: AidModel, searched: SearchModel, seconds: float, runs: int
) -> dict[str, str]:
    """By what they are about."""
    return {
        "loop": (
            "second order, damping 0.71, two correlations of 10 ms within a bit: "
            f"closed {1.0 / PAIR_S:g} times a second; cross product over the signal's power"
        ),
        "lock": f"lost once the frequency is {LOST_HZ:g} Hz off, within {seconds:g} s",
        "runs": f"{runs}, the same noise for every loop and level",
        "random motion": (
            f"speeds {motion.speed_mps:g} +/- {motion.speed_std_mps:g} m/s over "
            f"{motion.speed_time_s:g} s, {motion.lateral_std_mps2:g} m/s2 sideways over "
            f"{motion.lateral_time_s:g} s, satellites above {motion.lowest_deg:g} deg"
        ),
        "satellite": "its own motion and the bits are known or followed, and told to both loops",
        "clock": (
            f"the receiver's walks {motion.clock_hz_per_sqrt_s:g} Hz a root second; the aid "
            f"knows it once in {aid.clock_interval_s:g} s to {aid.clock_std_hz:g} Hz"
        ),
        "aid": (
            f"velocity only, every {aid.interval_s:g} s and {aid.latency_s:g} s late, carried on "
            "by the last two (held, or every 0.01 s and 0.01 s late, where a row says so); "
            f"speed off by {aid.speed_std_mps:.2g} m/s over {aid.speed_time_s:g} s, heading by "
            f"{aid.heading_std_deg:.2g} deg over {aid.heading_time_s:g} s (one sigma)"
        ),
        "bandwidth": (
            "what the aid leaves of the jerk stresses the narrow loop as all of it does that "
            "of 1.2 Hz (equation 3)"
        ),
        "search": (
            f"{searched.correlations} correlations of 10 ms squared and added, cells of "
            f"{searched.cell_hz:g} Hz by {searched.code_cells} half chips, one false alarm in "
            f"{1.0 / searched.false_alarm:g} searches, {100.0 * searched.detection:g} % "
            f"detected; an aid's range is {SIGMAS:g} stds to either side"
        ),
    }
