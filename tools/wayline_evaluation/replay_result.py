"""Pure: what came out of a replay, as studies read it."""

from dataclasses import dataclass

from wayline.messages import GpsFix, Verdict
from wayline_evaluation.estimates import Estimates


@dataclass(frozen=True, slots=True)
class Replayed:
    """What a replay said, and what it was given of GPS."""

    drive: str
    start_s: float
    """Smallest t_ns of the drive's input, Unix seconds; outages are counted from it."""
    end_s: float
    estimates: Estimates
    fixes: tuple[GpsFix, ...]
    verdicts: tuple[Verdict, ...]
    lost_share: float
    """Of the poses."""
