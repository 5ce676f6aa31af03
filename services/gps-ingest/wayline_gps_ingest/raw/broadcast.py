"""What satellites broadcast of themselves, and what follows from it, by RTKLIB (pyrtklib5).

With `rinex` the only module that imports the library: both are loaded where measurements come
without the places of their satellites, or with the air's delay in them, and nowhere else.
"""

import weakref
from collections.abc import Sequence
from functools import cache, lru_cache
from pathlib import Path

import pyrtklib5 as rtklib

from wayline.errors import InputError
from wayline.messages import EARLIEST_NS
from wayline.satellites.earth import SPEED_OF_LIGHT_MPS, Vector
from wayline.satellites.gps_time import week_and_tow_s
from wayline_gps_ingest.raw.air import L1_HZ, SignalPath
from wayline_gps_ingest.raw.ephemerides import State, Wanted
from wayline_gps_ingest.raw.plain_file import plain_copy

SYSTEMS = {
    "gps": rtklib.SYS_GPS,
    "glonass": rtklib.SYS_GLO,
    "galileo": rtklib.SYS_GAL,
    "beidou": rtklib.SYS_CMP,
    "qzss": rtklib.SYS_QZS,
    "sbas": rtklib.SYS_SBS,
    "navic": rtklib.SYS_IRN,
}
NAMES = {number: name for name, number in SYSTEMS.items()}
QZSS_FIRST = 192
"""Added to QZSS's own numbers by RTKLIB, as by IS-QZSS."""
GALILEO_TGD = 1
"""Of RTKLIB's group delays the one for E1 with clocks of I/NAV; else the first."""
HUMIDITY = 0.7
"""RTKLIB's own, for the troposphere."""
SATELLITES_MAX = 255
"""As many as an RXM-RAWX can tell of."""
ALL_KINDS = 0xFF
"""Of ephemerides."""
PRN = rtklib.Arr1Dint(1)
"""Where RTKLIB writes a satellite's own number."""
EPHEMERIS = 2
"""What RTKLIB answers when a message completes an ephemeris."""


class Asked:
    """Lists that RTKLIB reads and fills.

    Made once a process, which one thread at a time may use: the binding never gives back what a
    list, or a look into a struct, has taken.
    """

    def __init__(self) -> None:
        self.signals = rtklib.Arr1Dobsd_t(SATELLITES_MAX)
        self.slots = [self.signals[place] for place in range(SATELLITES_MAX)]
        self.ranges_m = [slot.P for slot in self.slots]
        self.places = rtklib.Arr1Ddouble(6 * SATELLITES_MAX)
        """Places and motions."""
        self.clocks = rtklib.Arr1Ddouble(2 * SATELLITES_MAX)
        """Offsets and drifts."""
        self.variances = rtklib.Arr1Ddouble(SATELLITES_MAX)
        self.health = rtklib.Arr1Dint(SATELLITES_MAX)
        self.place, self.direction = rtklib.Arr1Ddouble(3), rtklib.Arr1Ddouble(2)
        """Of a receiver, and of a satellite seen from there; in radians and metres."""


@cache
def _lists() -> Asked:
    return Asked()


class Broadcast:
    """Ephemerides of all systems, from navigation files or as a receiver passes them on.

    An ephemeris counts for as long as RTKLIB takes it: two hours around its time for GPS, half an
    hour for GLONASS, the newest of each satellite.
    """

    def __init__(self) -> None:
        self._raw = rtklib.raw_t()
        rtklib.init_raw(self._raw, rtklib.STRFMT_UBX)
        weakref.finalize(self, rtklib.free_raw, self._raw)
        self._nav = self._raw.nav
        self._of_files = False
        self._ionosphere = self._nav.ion_gps
        self._asked = _lists()
        self._group_delays_s: dict[int, float] = {}
        self._known: set[int] = set()

    def read(self, path: Path) -> None:
        """Take a RINEX navigation file, beside those read before, in place of what was heard.

        Raises InputError for a file that holds no ephemeris.
        """
        if not self._of_files:
            self._of_files, self._nav = True, rtklib.nav_t()
            weakref.finalize(self, rtklib.freenav, self._nav, ALL_KINDS)
            self._ionosphere = self._nav.ion_gps
        before = self._nav.n + self._nav.ng
        with plain_copy(path) as plain:
            rtklib.readrnx(str(plain), 1, "", rtklib.obs_t(), self._nav, rtklib.sta_t())
        if self._nav.n + self._nav.ng == before:
            mend = "give a RINEX navigation file (.nav, .rnx, .26n)"
            raise InputError(str(path), "holds no ephemeris", mend)
        rtklib.uniqnav(self._nav)
        for place in range(self._nav.n):
            self._take(self._nav.eph[place])
        self._known |= {self._nav.geph[place].sat for place in range(self._nav.ng)}

    def hear(self, message: bytes, t_ns: int) -> None:
        """Take a whole RXM-SFRBX message that came at about a time (Unix ns)."""
        self._raw.time = _time(t_ns)
        answer = 0
        for byte in message:
            answer = rtklib.input_ubx(self._raw, byte)
        if answer != EPHEMERIS:
            return
        satellite = self._raw.ephsat
        if rtklib.satsys(satellite, PRN) == rtklib.SYS_GLO:
            self._known.add(satellite)
        else:
            self._take(self._raw.nav.eph[satellite - 1 + rtklib.MAXSAT * self._raw.ephset])

    def _take(self, ephemeris: rtklib.eph_t) -> None:
        satellite = ephemeris.sat
        self._known.add(satellite)
        is_galileo = rtklib.satsys(satellite, PRN) == rtklib.SYS_GAL
        self._group_delays_s[satellite] = ephemeris.tgd[GALILEO_TGD if is_galileo else 0]

    def states(self, t_ns: int, wanted: Sequence[Wanted]) -> list[State | None]:
        """Satellites whose signals were received at a time (Unix ns); None without ephemeris."""
        asked, time = self._asked, _time(t_ns)
        wanted = wanted[:SATELLITES_MAX]
        numbers = [number_of(each.system, each.prn) for each in wanted]
        for slot, range_m, number, each in zip(
            asked.slots, asked.ranges_m, numbers, wanted, strict=False
        ):
            slot.time, slot.sat = time, number
            range_m[0] = each.pseudorange_m
        rtklib.satposs(
            time,
            asked.signals.ptr,
            len(wanted),
            self._nav,
            rtklib.EPHOPT_BRDC,
            asked.places,
            asked.clocks,
            asked.variances,
            asked.health,
        )
        return [self._state(number, place) for place, number in enumerate(numbers)]

    def _state(self, number: int, at: int) -> State | None:
        """What RTKLIB has answered of the satellite at a place of the list."""
        asked = self._asked
        x, y, z, vx, vy, vz = (asked.places[6 * at + axis] for axis in range(6))
        if number not in self._known or x == y == z == 0.0:
            return None
        bias_s = asked.clocks[2 * at] - self._group_delays_s.get(number, 0.0)
        return State(
            Vector(x, y, z),
            Vector(vx, vy, vz),
            SPEED_OF_LIGHT_MPS * bias_s,
            SPEED_OF_LIGHT_MPS * asked.clocks[2 * at + 1],
            asked.health[at] == 0,
        )

    def is_known(self, system: str, prn: int) -> bool:
        """Whether there is an ephemeris of a satellite, of whatever time."""
        return number_of(system, prn) in self._known

    def delay_m(self, path: SignalPath) -> float:
        """By how much the air makes a pseudorange too long (Klobuchar, Saastamoinen)."""
        time, place, direction = _time(path.t_ns), self._asked.place, self._asked.direction
        place[0], place[1] = path.lat_deg * rtklib.D2R, path.lon_deg * rtklib.D2R
        place[2] = path.height_m
        direction[0], direction[1] = path.azimuth_deg * rtklib.D2R, path.elevation_deg * rtklib.D2R
        bent_m = rtklib.ionmodel(time, self._ionosphere, place, direction)
        bent_m *= (L1_HZ / path.carrier_hz) ** 2
        return float(bent_m + rtklib.tropmodel(time, place, direction, HUMIDITY))


def number_of(system: str, prn: int) -> int:
    """RTKLIB's number of a satellite; 0 for one that it does not know."""
    first = QZSS_FIRST if system == "qzss" and prn < QZSS_FIRST else 0
    return int(rtklib.satno(SYSTEMS.get(system, rtklib.SYS_NONE), prn + first))


def satellite_of(number: int) -> tuple[str, int] | None:
    """System and its own number of a satellite that RTKLIB numbers; None of what is none."""
    name = NAMES.get(rtklib.satsys(number, PRN))
    if name is None:
        return None
    return name, PRN[0] - (QZSS_FIRST if name == "qzss" else 0)


@lru_cache(maxsize=1)
def _time(t_ns: int) -> rtklib.gtime_t:
    return rtklib.gpst2time(*week_and_tow_s(max(t_ns, EARLIEST_NS)))
