"""Pure: vehicles that may be the one that is followed, each from one standstill to the next.

Between two standstills a point speeds up, drives at one share of the planned speeds, and brakes.
Times are seconds after an instant that the filter keeps.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline_eta.expected_motion import RATE_MPS2, ExpectedMotion

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.intp]

BETWEEN = -1
"""In place of a stop's index: the standstill is between stops."""
TINY_S = 1e-9


class Leg(NamedTuple):
    """Ways from where vehicles set out, or are first thought of, to a standstill; (n,) each."""

    begins_m: Floats
    ends_m: Floats
    set_out_s: Floats
    rates: Floats
    """Of the planned speeds, where they neither speed up nor brake."""
    ups_s: Floats
    """How long they speed up; 0 for those that begin under way."""
    downs_s: Floats
    """How long they brake."""
    comes_s: Floats
    begun_s: Floats
    """Planned driving from the route's start to where they begin, in seconds: asked for at every
    instant, and the same as long as they are on the leg."""
    ended_s: Floats
    """Planned driving from the route's start to where they end."""

    def planned_by(self, motion: ExpectedMotion) -> "Leg":
        """The same ways, at the same paces, by another plan."""
        return self._replace(
            begun_s=motion.driven_s(self.begins_m), ended_s=motion.driven_s(self.ends_m)
        )


class Points(NamedTuple):
    """Each on a leg, or standing where it has come to; the rest of shape (n,) each."""

    leg: Leg
    leaves_s: Floats
    """When they leave where the leg ends."""
    stops: Indices
    """At which stop that is, BETWEEN for none."""
    paces: Floats
    """The vehicle's, of all its legs."""
    extras_s: Floats
    """Its dwells beyond those that are expected."""

    def chosen(self, which: Indices) -> "Points":
        """Some of them, some several times."""
        return Points(
            Leg(*(field[which] for field in self.leg)),
            self.leaves_s[which],
            self.stops[which],
            self.paces[which],
            self.extras_s[which],
        )

    def stands(self, at_s: float) -> Flags:
        """Whether they have come to the leg's end."""
        return self.leg.comes_s <= at_s

    def left_s(self, at_s: float) -> Floats:
        """Still to stand; 0 under way."""
        return np.where(self.stands(at_s), np.maximum(self.leaves_s - at_s, 0.0), 0.0)

    def stood_s(self, at_s: float) -> Floats:
        """Since they came to stand; 0 under way."""
        return np.maximum(at_s - self.leg.comes_s, 0.0)

    def phases(self, at_s: float) -> Floats:
        """Share of their speed under way that they have: 1 where they speed up or brake no more."""
        leg = self.leg
        since_s, until_s = at_s - leg.set_out_s, leg.comes_s - at_s
        up = np.where(leg.ups_s > 0.0, since_s / np.maximum(leg.ups_s, TINY_S), 1.0)
        return np.clip(np.minimum(up, until_s / np.maximum(leg.downs_s, TINY_S)), 0.0, 1.0)

    def speeds_mps(self, at_s: float, places_m: Floats, motion: ExpectedMotion) -> Floats:
        """At an instant, when they are at `places_m`."""
        return np.asarray(self.phases(at_s) * self.leg.rates * motion.speeds_mps(places_m))

    def places_m(self, at_s: float, motion: ExpectedMotion) -> Floats:
        """Along the route at an instant."""
        leg = self.leg
        since_s = np.maximum(at_s - leg.set_out_s, 0.0)
        until_s = np.maximum(leg.comes_s - at_s, 0.0)
        ups_s, downs_s = np.maximum(leg.ups_s, TINY_S), np.maximum(leg.downs_s, TINY_S)
        # planned seconds of driving, at a rate that rises and falls evenly
        gone_s = np.where(since_s < ups_s, since_s**2 / (2.0 * ups_s), since_s - ups_s / 2.0)
        begun_s = leg.begun_s + leg.rates * gone_s
        ended_s = leg.ended_s - leg.rates * until_s**2 / (2.0 * downs_s)
        places_m = motion.distance_at(np.where(until_s < downs_s, ended_s, begun_s))
        return np.where(until_s <= 0.0, leg.ends_m, np.clip(places_m, leg.begins_m, leg.ends_m))


def made_leg(
    motion: ExpectedMotion,
    begins_m: Floats,
    ends_m: Floats,
    set_out_s: Floats,
    rates: Floats,
    *,
    rolling: bool,
) -> Leg:
    """A leg at so much of the planned speeds; `rolling` ones begin under way."""
    begun_s, ended_s = motion.driven_s(begins_m), motion.driven_s(ends_m)
    planned_s = ended_s - begun_s
    speeds_mps = rates * (ends_m - begins_m) / np.maximum(planned_s, TINY_S)
    downs_s = np.maximum(speeds_mps / RATE_MPS2, TINY_S)
    ups_s = np.zeros(len(downs_s)) if rolling else downs_s
    # a way too short for its speed is driven at less
    share = np.sqrt(np.minimum(planned_s / rates / ((ups_s + downs_s) / 2.0), 1.0))
    share = np.maximum(share, TINY_S)
    rates, ups_s, downs_s = share * rates, share * ups_s, share * downs_s
    whole_s = planned_s / rates + (ups_s + downs_s) / 2.0
    comes_s = set_out_s + whole_s
    return Leg(begins_m, ends_m, set_out_s, rates, ups_s, downs_s, comes_s, begun_s, ended_s)
