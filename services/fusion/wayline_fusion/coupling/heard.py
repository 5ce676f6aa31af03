"""Pure: the satellites that a receiver has told of, and where they are since."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.messages import GpsRaw, RawSatellite
from wayline.satellites.doppler import L1_HZ, Floats, Orbits, carried, orbits_of
from wayline.satellites.earth import SPEED_OF_LIGHT_MPS

KEPT_NS = 600_000_000_000
"""For so long gravity alone tells a satellite's motion to 0.06 m/s."""
ANCHORED_NS = 10_000_000_000
"""Over so long an even acceleration is as good as the orbit."""

NEAREST_M, FARTHEST_M = 6.6e6, 6e7
"""From the Earth's centre: above its air, and beyond all that navigation satellites use."""
FASTEST_MPS = 1e4

Name = tuple[str, int]
"""System and number."""


class Heard(NamedTuple):
    """Satellites whose places and motions are known, one row each."""

    names: tuple[Name, ...]
    orbits: Orbits
    heard_ns: NDArray[np.int64]
    """When each was last told of."""
    hz_per_mps: Floats
    """Doppler over range rate, negative."""
    clock_biases_m: Floats
    clock_drifts_mps: Floats

    def at(self, t_ns: int) -> "Heard":
        """With orbits that are good for an instant, those that are too old left out."""
        young = t_ns - self.heard_ns <= KEPT_NS
        if not young.all():
            return _rows(self, young).at(t_ns)
        if len(self.names) and np.abs(t_ns - self.orbits.t_ns).max() > ANCHORED_NS:
            return self._replace(orbits=carried(self.orbits, t_ns))
        return self

    def with_epoch(self, epoch: "Heard") -> "Heard":
        """With the rows of a newer epoch in place of older ones of the same satellites."""
        told = set(epoch.names)
        kept = _rows(self, np.array([name not in told for name in self.names], dtype=np.bool_))
        return Heard(
            names=(*kept.names, *epoch.names),
            orbits=Orbits(
                np.concatenate((kept.orbits.places_m, epoch.orbits.places_m)),
                np.concatenate((kept.orbits.velocities_mps, epoch.orbits.velocities_mps)),
                np.concatenate((kept.orbits.accelerations_mps2, epoch.orbits.accelerations_mps2)),
                np.concatenate((kept.orbits.t_ns, epoch.orbits.t_ns)),
            ),
            heard_ns=np.concatenate((kept.heard_ns, epoch.heard_ns)),
            hz_per_mps=np.concatenate((kept.hz_per_mps, epoch.hz_per_mps)),
            clock_biases_m=np.concatenate((kept.clock_biases_m, epoch.clock_biases_m)),
            clock_drifts_mps=np.concatenate((kept.clock_drifts_mps, epoch.clock_drifts_mps)),
        )


def _rows(heard: Heard, chosen: NDArray[np.bool_]) -> Heard:
    orbits = heard.orbits
    return Heard(
        names=tuple(name for name, is_kept in zip(heard.names, chosen, strict=True) if is_kept),
        orbits=Orbits(
            orbits.places_m[chosen],
            orbits.velocities_mps[chosen],
            orbits.accelerations_mps2[chosen],
            orbits.t_ns[chosen],
        ),
        heard_ns=heard.heard_ns[chosen],
        hz_per_mps=heard.hz_per_mps[chosen],
        clock_biases_m=heard.clock_biases_m[chosen],
        clock_drifts_mps=heard.clock_drifts_mps[chosen],
    )


def placed(epoch: GpsRaw) -> list[RawSatellite]:
    """Those satellites of an epoch whose place and motion it tells, where these can be."""
    return [each for each in epoch.satellites if _is_orbit(each)]


def _is_orbit(told: RawSatellite) -> bool:
    place, motion = (told.x_m, told.y_m, told.z_m), (told.vx_mps, told.vy_mps, told.vz_mps)
    known = [value for value in (*place, *motion) if value is not None]
    if len(known) < 6:
        return False
    radius_m, speed_mps = math.hypot(*known[:3]), math.hypot(*known[3:])
    return NEAREST_M <= radius_m <= FARTHEST_M and speed_mps <= FASTEST_MPS


def heard_of(satellites: list[RawSatellite], t_ns: int) -> Heard:
    """Rows of satellites whose place and motion are told, in their order."""
    table = np.array(
        [
            (
                each.x_m,
                each.y_m,
                each.z_m,
                each.vx_mps,
                each.vy_mps,
                each.vz_mps,
                each.carrier_hz or L1_HZ,
                each.clock_bias_m or 0.0,
                each.clock_drift_mps or 0.0,
            )
            for each in satellites
        ],
        dtype=np.float64,
    ).reshape(-1, 9)
    times_ns = np.full(len(satellites), t_ns, dtype=np.int64)
    return Heard(
        names=tuple((each.system, each.prn) for each in satellites),
        orbits=orbits_of(table[:, :3], table[:, 3:6], times_ns),
        heard_ns=times_ns,
        hz_per_mps=-table[:, 6] / SPEED_OF_LIGHT_MPS,
        clock_biases_m=table[:, 7],
        clock_drifts_mps=table[:, 8],
    )


NOTHING_HEARD = heard_of([], 0)
