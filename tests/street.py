"""A vehicle that drives straight north at 10 m/s up a street of 2 %, and the route along it."""

import json
import time
from collections.abc import Mapping
from pathlib import Path

import zenoh

from wayline.bus import Publishers
from wayline.codec import encode
from wayline.geo import WGS84
from wayline.messages import GpsFix, Health

VEHICLE = "bus-7"
ROUTE = "street"
LAT_DEG, LON_DEG = 55.0, 10.0
SPEED_MPS = 10.0
LENGTH_M = 3000.0
STOPS_M = (200.0, 1500.0, 2900.0)


def place(distance_m: float) -> tuple[float, float]:
    """Latitude and longitude so far along the street."""
    lon_deg, lat_deg, _ = WGS84.fwd(LON_DEG, LAT_DEG, 0.0, distance_m)
    return float(lat_deg), float(lon_deg)


def write_route(path: Path) -> Path:
    """The street with three stops as a route's GeoJSON."""
    line = {"type": "LineString", "coordinates": [_position(0.0), _position(LENGTH_M)]}
    route = {"route_id": ROUTE, "name": "Street", "loop": False, "speeds_mps": [SPEED_MPS]}
    stops = [
        _feature(
            {"type": "Point", "coordinates": _position(distance_m)},
            {"stop_id": f"stop-{number}", "name": f"Stop {number}", "dwell_s": 10.0},
        )
        for number, distance_m in enumerate(STOPS_M, 1)
    ]
    features = [_feature(line, route), *stops]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def _position(distance_m: float) -> list[float]:
    lat_deg, lon_deg = place(distance_m)
    return [lon_deg, lat_deg]


def _feature(geometry: Mapping[str, object], properties: Mapping[str, object]) -> dict[str, object]:
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def street_fix(start_ns: int, second: int) -> GpsFix:
    """What a good receiver says so many seconds after the start."""
    lat_deg, lon_deg = place(SPEED_MPS * second)
    return GpsFix(
        t_ns=start_ns + second * 1_000_000_000,
        valid=True,
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        alt_m=50.0 + 0.02 * SPEED_MPS * second,
        speed_mps=SPEED_MPS,
        course_deg=0.0,
        mode=3,
        fix="gps",
        satellites=9,
        hdop=0.9,
        pdop=1.5,
    )


class Receiver:
    """Publishes fixes as gps-ingest does when it plays a drive, as fast as they are asked for."""

    def __init__(self, session: zenoh.Session, start_ns: int) -> None:
        self._publishers = Publishers(session)
        self._start_ns = start_ns
        self._second = 0

    @property
    def t_ns(self) -> int:
        """The instant of the last fix."""
        return self._start_ns + (self._second - 1) * 1_000_000_000

    def drive(self, seconds: int) -> None:
        """Publish the fixes of so many seconds at once."""
        # under a name of its own: the system's gps-ingest plays nothing and says so
        self._publishers.put(VEHICLE, "health", "play", encode(self._health()))
        for _ in range(seconds):
            fix = street_fix(self._start_ns, self._second)
            self.put("gps_fix", encode(fix))
            self._second += 1

    def _health(self) -> Health:
        """The drive is a recording: its times are not those of the host's clock."""
        return Health(
            t_ns=time.time_ns(),
            service="play",
            version="0",
            started_ns=time.time_ns(),
            recorded=True,
        )

    def put(self, topic: str, payload: bytes) -> None:
        """Publish any payload."""
        self._publishers.put(VEHICLE, topic, "gps-ingest", payload)

    def close(self) -> None:
        """Publish no more."""
        self._publishers.close()
