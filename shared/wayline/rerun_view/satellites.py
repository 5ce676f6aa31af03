"""Satellites in Rerun: a sky plot and how far off each range is, once fusion has judged them."""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from wayline.messages import GpsRaw, RawSatellite, Verdict
from wayline.rerun_view.columns import Columns, SkyPoint
from wayline.rerun_view.styles import ACCEPTED, REJECTED
from wayline.satellites.names import name_of
from wayline.satellites.sight import ground_at, seen_from

RANGES, RATES = "gps_raw", "gps_raw_rate"
"""Sensors, before the satellite's name."""
EPOCHS_KEPT = 32
"""Whose verdicts may still come."""


class Direction(NamedTuple):
    """Where a satellite stands."""

    azimuth_rad: float
    elevation_rad: float

    @property
    def in_sky(self) -> tuple[float, float]:
        """Right and down of the zenith, north upwards; the horizon is 90 away."""
        from_zenith_deg = 90.0 - math.degrees(self.elevation_rad)
        sin, cos = math.sin(self.azimuth_rad), math.cos(self.azimuth_rad)
        return from_zenith_deg * sin, -from_zenith_deg * cos


def is_of_satellite(verdict: Verdict) -> bool:
    """Whether it is of one satellite's range or range rate."""
    return verdict.sensor.partition(" ")[0] in {RANGES, RATES} and " " in verdict.sensor


class SatelliteView:
    """Of one vehicle."""

    def __init__(self, columns: Columns) -> None:
        self._columns = columns
        self._skies: dict[int, dict[str, Direction]] = {}

    def hear(self, epoch: GpsRaw, place_deg: tuple[float, float] | None) -> None:
        """Remember where an epoch's satellites stand, as seen from about where the vehicle is."""
        found = ((each, _direction(each, place_deg)) for each in epoch.satellites)
        self._skies[epoch.t_ns] = {
            name_of(each.system, each.prn): where for each, where in found if where is not None
        }
        if len(self._skies) > EPOCHS_KEPT:
            del self._skies[next(iter(self._skies))]

    def judge(self, verdicts: Iterable[Verdict]) -> None:
        """Draw what has become of satellites."""
        by_epoch: dict[int, list[SkyPoint]] = {}
        for verdict in verdicts:
            sensor, _, name = verdict.sensor.partition(" ")
            self._columns.scalars(f"{sensor}/{name}", verdict.t_ns, math.sqrt(verdict.nis))
            where = self._skies.get(verdict.t_ns, {}).get(name)
            if sensor == RANGES and where is not None:
                colour = ACCEPTED if verdict.accepted else REJECTED
                by_epoch.setdefault(verdict.t_ns, []).append(SkyPoint(where.in_sky, colour, name))
        for t_ns, points in by_epoch.items():
            self._columns.sky("sky/satellites", t_ns, points)


def _direction(satellite: RawSatellite, place_deg: tuple[float, float] | None) -> Direction | None:
    """As told, else by its place."""
    if satellite.azimuth_deg is not None and satellite.elevation_deg is not None:
        azimuth_rad = math.radians(satellite.azimuth_deg)
        return Direction(azimuth_rad, math.radians(satellite.elevation_deg))
    x_m, y_m, z_m = satellite.x_m, satellite.y_m, satellite.z_m
    if place_deg is None or x_m is None or y_m is None or z_m is None:
        return None
    place_m = np.array([[x_m, y_m, z_m]])
    sight = seen_from(ground_at(*place_deg, 0.0), place_m, np.zeros((1, 3)))
    east, north, up = sight.directions[0].tolist()
    return Direction(math.atan2(east, north), math.asin(up))
