"""Pure: what is collected of a run while it is driven."""

import math
from bisect import bisect_right
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from wayline.line import Floats
from wayline.matching.network import Sight
from wayline.vertical.own_slope import OwnSlope
from wayline.vertical.propulsion import Push
from wayline_slope_map.left_out import Spans
from wayline_slope_map.matching import Match

TRACK_STEP_NS = 400_000_000
"""Between the kept instants of distance against time; straight between them to 0.1 m."""


class Place(NamedTuple):
    """Where the vehicle was, and on which known road if on any."""

    t_ns: int
    travelled_m: float
    lat_deg: float
    lon_deg: float
    course_deg: float
    """Direction of travel."""
    match: Match | None
    std_m: float = 0.0
    """One sigma of the worse axis."""
    is_reckoned: bool = False
    """By wheels and gyro, without a fix that was believed."""

    @property
    def sight(self) -> Sight:
        """As the matcher sees it."""
        return Sight(self.t_ns, self.lat_deg, self.lon_deg, self.std_m, self.course_deg)


class Altitude(NamedTuple):
    """A GPS altitude above mean sea level, at its own instant."""

    t_ns: int
    alt_m: float
    std_m: float
    source: str = ""
    """The receiver."""


class Pressure(NamedTuple):
    """A barometer reading, at its own instant."""

    t_ns: int
    pressure_pa: float


@dataclass
class Track:
    """One run: distance against time, places every 10 m, and what was measured of the height."""

    times_ns: list[int] = field(default_factory=list)
    travelled_m: list[float] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    altitudes: list[Altitude] = field(default_factory=list)
    pressures: list[Pressure] = field(default_factory=list)
    pushes: list[Push] = field(default_factory=list)
    own_slopes: list[OwnSlope] = field(default_factory=list)
    left_out: Spans = field(default_factory=Spans)
    """What was left out while it was driven."""
    doubted_from_m: float = math.inf
    """Travelled; from there on it is not known which road was driven."""

    def travel(self, t_ns: int, travelled_m: float) -> None:
        """Note a distance, unless the last one was just now."""
        if not self.times_ns or t_ns - self.times_ns[-1] >= TRACK_STEP_NS:
            self.times_ns.append(t_ns)
            self.travelled_m.append(travelled_m)

    def end_at(self, travelled_m: float) -> None:
        """Let it end where so much was travelled; what was measured later tells of another run."""
        last = bisect_right(self.travelled_m, travelled_m)
        del self.times_ns[last:], self.travelled_m[last:]
        del self.places[bisect_right(self.places, travelled_m, key=lambda each: each.travelled_m) :]

    @property
    def tells_heights(self) -> bool:
        """Whether anything was measured of the height."""
        return any((self.altitudes, self.pressures, self.pushes, self.own_slopes))

    @property
    def start_ns(self) -> int:
        """When the run began; times in seconds count from here."""
        return self.times_ns[0]

    def seconds(self, times_ns: list[int]) -> Floats:
        """Seconds since the start."""
        return (np.array(times_ns, dtype=np.int64) - self.start_ns) / 1e9

    def travelled_at(self, times_s: Floats) -> Floats:
        """Distance travelled at instants between the first and the last."""
        return np.interp(times_s, self.seconds(self.times_ns), self.travelled_m)

    def seconds_at(self, travelled_m: Floats) -> Floats:
        """When distances were reached, in seconds since the start."""
        return np.interp(travelled_m, self.travelled_m, self.seconds(self.times_ns))
