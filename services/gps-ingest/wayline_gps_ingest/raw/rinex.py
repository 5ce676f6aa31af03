"""Reads a RINEX observation file, an epoch at a time, by RTKLIB (pyrtklib5)."""

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import pyrtklib5 as rtklib

from wayline.errors import InputError
from wayline.messages import RawSatellite
from wayline.satellites.gps_time import GPS_EPOCH_UNIX_S, WEEK_S, unix_ns
from wayline_gps_ingest.raw.broadcast import satellite_of
from wayline_gps_ingest.raw.ephemerides import Placing
from wayline_gps_ingest.raw.epoch import RawEpoch
from wayline_gps_ingest.raw.measured import raw_satellite
from wayline_gps_ingest.raw.plain_file import plain_copy

OBSERVATIONS, END, ERROR = 1, -2, -1
"""What RTKLIB answers."""


class Slot(NamedTuple):
    """A place for one satellite in RTKLIB's epoch, and its lists by frequency.

    They stay where they are: the binding never gives back what a look into a struct has taken.
    """

    signal: rtklib.obsd_t
    pseudoranges_m: rtklib.Arr1Ddouble
    dopplers_hz: rtklib.Arr1Dfloat
    strengths_dbhz: rtklib.Arr1Dfloat
    codes: Sequence[int]

    @classmethod
    def of(cls, signal: rtklib.obsd_t) -> "Slot":
        """The place and its lists."""
        return cls(signal, signal.P, signal.D, signal.SNR, signal.code)


class RinexLog:
    """A file of versions 2 to 4, read once, as epochs with their satellites' places.

    Of each satellite its first frequency is read. Counted in `faults`: `malformed` epochs.
    """

    def __init__(self, path: Path, placing: Placing) -> None:
        self._path = path
        self._placing = placing
        self.faults: Counter[str] = Counter()
        self._slots: list[Slot] = []

    def __iter__(self) -> Iterator[RawEpoch]:
        with plain_copy(self._path) as plain:
            yield from self._epochs(str(plain))

    def _epochs(self, path: str) -> Iterator[RawEpoch]:
        control = rtklib.rnxctr_t()
        rtklib.init_rnxctr(control)
        try:
            file = rtklib.FileWrapper(path, "r")
            if not rtklib.open_rnxctr(control, file):
                self.faults["malformed"] += 1
                return
            while (answer := rtklib.input_rnxctr(control, file)) != END:
                if answer == OBSERVATIONS:
                    yield self._epoch(control)
                elif answer == ERROR:
                    self.faults["malformed"] += 1
        finally:
            rtklib.free_rnxctr(control)

    def _epoch(self, control: rtklib.rnxctr_t) -> RawEpoch:
        count = control.obs.n
        for place in range(len(self._slots), count):
            self._slots.append(Slot.of(control.obs.data[place]))
        slots = self._slots[:count]
        time = slots[0].signal.time
        week, tow_s = divmod(time.time - GPS_EPOCH_UNIX_S, WEEK_S)
        t_ns = unix_ns(week, tow_s + time.sec)
        read = [_satellite(slot, control.nav) for slot in slots]
        measured = [satellite for satellite in read if satellite is not None]
        return RawEpoch(t_ns=t_ns, satellites=self._placing.satellites(t_ns, measured))

    def nothing(self) -> InputError:
        """Why it holds no epoch."""
        what = "holds no epoch that can be read"
        return InputError(str(self._path), what, "give a RINEX observation file of version 2 to 4")


def _satellite(slot: Slot, nav: rtklib.nav_t) -> RawSatellite | None:
    """A satellite's first signal; 0 is what RTKLIB has for what is not told."""
    number = slot.signal.sat
    named = satellite_of(number)
    if named is None:
        return None
    numbers = {
        "pseudorange_m": slot.pseudoranges_m[0],
        "doppler_hz": slot.dopplers_hz[0],
        "cn0_dbhz": slot.strengths_dbhz[0],
        "carrier_hz": rtklib.sat2freq(number, slot.codes[0], nav),
    }
    return raw_satellite(*named, {name: value for name, value in numbers.items() if value})
