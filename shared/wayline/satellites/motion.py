"""Pure: satellites' motions where only their places are told."""

from wayline.satellites.earth import Vector, acceleration_mps2

SECOND_NS = 1_000_000_000
BETWEEN_MAX_NS = 30 * SECOND_NS
"""Over a longer time the earth's pull is no longer the same."""
BETWEEN_MIN_NS = SECOND_NS // 2
"""Over a shorter time, places told to a millimetre tell no motion to a millimetre a second."""
OFF_MAX_MPS = 2.0
"""A motion that changes by more than gravity lets it is a place told by other ephemerides."""

Satellite = tuple[str, int]
"""System and number."""


class Motions:
    """Earth-fixed motions of satellites, differenced from the places told of them.

    The mean motion since a place told half a second to half a minute ago is carried to the present
    by gravity; it is exact to 0.01 m/s over a second. The first place of a satellite tells no
    motion, nor does one that a new set of ephemerides has moved.
    """

    def __init__(self) -> None:
        self._told: dict[Satellite, tuple[int, Vector]] = {}
        self._motions: dict[Satellite, tuple[int, Vector]] = {}

    def motion_mps(self, satellite: Satellite, t_ns: int, place_m: Vector) -> Vector | None:
        """The motion at an instant (Unix ns) of which a place (ECEF, m) is told, in m/s."""
        earlier_ns, earlier_m = self._told.setdefault(satellite, (t_ns, place_m))
        between_ns = t_ns - earlier_ns
        if not 0 <= between_ns <= BETWEEN_MAX_NS:
            self._told[satellite] = (t_ns, place_m)
            self._motions.pop(satellite, None)
            return None
        if between_ns < BETWEEN_MIN_NS:
            return self._carried(satellite, t_ns, place_m)
        self._told[satellite] = (t_ns, place_m)
        motion_mps = _at_end(earlier_m, place_m, between_ns * 1e-9)
        expected_mps = self._carried(satellite, t_ns, place_m)
        self._motions[satellite] = (t_ns, motion_mps)
        if expected_mps is not None and motion_mps.moved(expected_mps, -1.0).length > OFF_MAX_MPS:
            del self._motions[satellite]
            return None
        return motion_mps

    def _carried(self, satellite: Satellite, t_ns: int, place_m: Vector) -> Vector | None:
        """The last known motion, as gravity has changed it since; None where none is known."""
        if satellite not in self._motions:
            return None
        then_ns, motion_mps = self._motions[satellite]
        return motion_mps.moved(acceleration_mps2(place_m, motion_mps), (t_ns - then_ns) * 1e-9)


def _at_end(earlier_m: Vector, place_m: Vector, between_s: float) -> Vector:
    """The motion at the later of two places."""
    gone_m = place_m.moved(earlier_m, -1.0)
    mean_mps = Vector(*(each / between_s for each in gone_m))
    return mean_mps.moved(acceleration_mps2(place_m, mean_mps), 0.5 * between_s)
