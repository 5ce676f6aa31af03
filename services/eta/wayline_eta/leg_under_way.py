"""Pure: what is left of the leg under way, by how long its beginning has taken.

A timetable says how long it is from stop to stop, and nothing of the way between: where the road
is quick and where lights are is not planned. So who is sooner on a part of the leg than evenly
planned is likely to meet its slow part later. The whole time T and when a share p of it is done are
taken to be normal: T off by s, the instant at p off from p T by a bridge of PROFILE_STD that is
known at both ends. What both say of T once p has taken so long (Bayes) is

    off = gone - p        in shares of what is expected of the leg
    T   = 1 + off s^2 / (p s^2 + (1 - p) PROFILE_STD^2)

of which `gone` is over.
"""

from wayline_eta.experience import Expected

PROFILE_STD = 0.25
"""Of shares of a leg's time. Cars between stands 1.5 to 30 km apart (28 recorded drives, 370 km)
are off by 0.11 where the whole is quicker than 14 m/s and by 0.3 where it takes 8 to 12."""
BELIEVED = 3.0
"""Standard deviations: who is off by more is in a jam, or lost."""
LEAST = 0.5
"""Of what is planned for the rest."""


def rest_of_leg(whole: Expected, done: float, gone_s: float | None) -> Expected:
    """After so long on a leg, at a place to where a share of its planned time is done.

    `gone_s` is None where nobody saw the vehicle begin it: then the rest takes its share.
    """
    left = 1.0 - done
    evenly = Expected(left * whole.seconds, left * whole.variance_s2)
    if gone_s is None or whole.seconds <= 0.0:
        return evenly
    square = whole.variance_s2 / whole.seconds**2
    profile = max(PROFILE_STD**2, square)
    unsure = done * square + left * profile
    off = gone_s / whole.seconds - done
    if off**2 > BELIEVED**2 * done * unsure:
        return evenly
    rest = max(left - off * (1.0 - square / unsure), LEAST * left)
    return Expected(rest * whole.seconds, whole.variance_s2 * left * profile / unsure)
