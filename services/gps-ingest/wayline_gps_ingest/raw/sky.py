"""Pure: where satellites stand in the receiver's sky, and pseudoranges without the air's delay."""

from collections.abc import Sequence

import msgspec

from wayline.messages import RawSatellite
from wayline.satellites.direction import Horizon
from wayline.satellites.place import ranged, rough_place_m
from wayline_gps_ingest.raw.air import L1_HZ, Air, SignalPath
from wayline_gps_ingest.raw.measured import place_of

SECOND_NS = 1_000_000_000
KNOWN_FOR_NS = 30 * SECOND_NS
"""A vehicle goes a kilometre meanwhile."""
SOUGHT_EVERY_NS = SECOND_NS


class Sky:
    """The sky over a receiver that is roughly found by its own pseudoranges.

    Found anew every half minute where its satellites let it, the last place stands for as long as
    they do not. Before it was ever found nothing is done to what is told.
    """

    def __init__(self, air: Air | None) -> None:
        self._air = air
        self._horizon: Horizon | None = None
        self._sought_ns: int | None = None

    def seen(self, t_ns: int, satellites: Sequence[RawSatellite]) -> tuple[RawSatellite, ...]:
        """Satellites of an instant (Unix ns) with directions, the air's delay taken out."""
        is_told = all(each.elevation_deg is not None for each in satellites)
        if is_told and self._air is None:
            return tuple(satellites)
        self._seek(t_ns, satellites)
        horizon = self._horizon
        if horizon is None:
            return tuple(satellites)
        return tuple(self._one_seen(t_ns, each, horizon) for each in satellites)

    def _seek(self, t_ns: int, satellites: Sequence[RawSatellite]) -> None:
        """Look where the receiver is, now and then."""
        wait_ns = SOUGHT_EVERY_NS if self._horizon is None else KNOWN_FOR_NS
        if self._sought_ns is not None and 0 <= t_ns - self._sought_ns < wait_ns:
            return
        self._sought_ns = t_ns
        known = [each for each in map(ranged, satellites) if each is not None]
        place_m = rough_place_m(known)
        if place_m is not None:
            self._horizon = Horizon.of(place_m)

    def _one_seen(self, t_ns: int, satellite: RawSatellite, horizon: Horizon) -> RawSatellite:
        place_m, elevation_deg = place_of(satellite), satellite.elevation_deg
        azimuth_deg, pseudorange_m = satellite.azimuth_deg, satellite.pseudorange_m
        if elevation_deg is None:
            if place_m is None:
                return satellite
            elevation_deg, azimuth_deg = horizon.direction_deg(place_m)
        if self._air is not None and pseudorange_m is not None:
            pseudorange_m -= self._air.delay_m(
                SignalPath(
                    t_ns=t_ns,
                    lat_deg=horizon.lat_deg,
                    lon_deg=horizon.lon_deg,
                    height_m=horizon.height_m,
                    elevation_deg=elevation_deg,
                    azimuth_deg=azimuth_deg or 0.0,
                    carrier_hz=satellite.carrier_hz or L1_HZ,
                )
            )
        return msgspec.structs.replace(
            satellite,
            elevation_deg=elevation_deg,
            azimuth_deg=azimuth_deg,
            pseudorange_m=pseudorange_m,
        )
