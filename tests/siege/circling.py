"""A vehicle that drives in circles for ever, ten times a second with wheels, gyro and receiver."""

import math
import threading
import time

import zenoh

from wayline.bus import Publishers
from wayline.codec import encode
from wayline.geo import WGS84
from wayline.messages import GpsFix, Gyro, Health, Message, Odometer

VEHICLE = "bus-7"
LAT_DEG, LON_DEG = 55.0, 10.0
RADIUS_M, SPEED_MPS = 600.0, 30.0
STEP_NS = 100_000_000
STEPS_A_SECOND = 10


class Circling:
    """Publishes in a thread until the block ends, so many times as fast as it drives.

    Its times begin now; faster than life it says that it plays a recording.
    """

    def __init__(self, session: zenoh.Session, speed: float = 1.0) -> None:
        self._publishers = Publishers(session)
        self._speed = speed
        start_ns = time.time_ns() if speed == 1.0 else time.time_ns() - 86_400 * 10**9
        self._start_ns = start_ns // 10**9 * 10**9
        self.late_s = 0.0
        """How late it was itself at the worst: what a busy machine costs everybody."""
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._drive)

    def __enter__(self) -> "Circling":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        self._publishers.close()

    def _drive(self) -> None:
        due_s, step = time.monotonic(), 0
        while not self._stop.wait(due_s - time.monotonic()):
            self.late_s = max(self.late_s, time.monotonic() - due_s)
            for message in self._messages(step):
                self._publishers.put(VEHICLE, message.topic, "gps-ingest", encode(message))
            due_s, step = due_s + 1.0 / STEPS_A_SECOND / self._speed, step + 1

    def _messages(self, step: int) -> list[Message]:
        t_ns = self._start_ns + step * STEP_NS
        turn_degps = math.degrees(SPEED_MPS / RADIUS_M)
        heard: list[Message] = [
            Odometer(t_ns=t_ns, speed_mps=SPEED_MPS),
            Gyro(t_ns=t_ns, yaw_rate_degps=turn_degps),
        ]
        if step % STEPS_A_SECOND == 0:
            heard.append(_fix(t_ns, turn_degps * step / STEPS_A_SECOND))
            if self._speed != 1.0:
                heard.append(_plays())
        return heard


def _fix(t_ns: int, turned_deg: float) -> GpsFix:
    """A quarter turn behind the way to the centre lies the course."""
    course_deg = turned_deg % 360.0
    lon_deg, lat_deg, _ = WGS84.fwd(LON_DEG, LAT_DEG, course_deg - 90.0, RADIUS_M)
    climb_m = 5.0 * math.sin(math.radians(course_deg))
    return GpsFix(
        t_ns=t_ns,
        valid=True,
        lat_deg=float(lat_deg),
        lon_deg=float(lon_deg),
        alt_m=50.0 + climb_m,
        speed_mps=SPEED_MPS,
        course_deg=course_deg,
        mode=3,
        fix="gps",
        satellites=9,
        hdop=0.9,
        pdop=1.5,
    )


def _plays() -> Health:
    now_ns = time.time_ns()
    return Health(t_ns=now_ns, service="gps-ingest", version="0", started_ns=now_ns, recorded=True)
