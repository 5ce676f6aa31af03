"""Pure: what a receiver's loops may expect, from the vehicle's motion and the last epochs."""

import math
from collections import deque

import numpy as np

from wayline.messages import AidedSatellite, Aiding, GpsRaw
from wayline.satellites.clock import walked_m
from wayline.satellites.doppler import (
    UNMODELLED_MPS2,
    Antenna,
    AntennaMotion,
    antenna_of,
    expected,
)
from wayline_fusion.coupling.epoch import Epoch, Learned, learned
from wayline_fusion.coupling.heard import NOTHING_HEARD, heard_of, placed
from wayline_fusion.coupling.past import Past

WAITING = 16
"""Epochs that are newer than the last tick; more are none."""
SILENT_NS = 10_000_000_000
"""A receiver that has told nothing for so long no longer keeps another from being aided."""


class Aider:
    """Predicts Dopplers and pseudoranges of every satellite that was told of and is up.

    Where satellites are, an epoch tells; from then on gravity does, for ten minutes. The receiver's
    clock is what the Dopplers have in common. How wrong the pose's velocity is, in units of its
    own std, shows in what they have not: an aid that has been wrong says so. Of several receivers
    the first is aided, as long as it tells anything: each has a clock of its own.
    """

    def __init__(self) -> None:
        self.geoid_sep_m = 0.0
        """Of the geoid above the ellipsoid, which satellites' places are told of."""
        self._past = Past()
        self._waiting: deque[GpsRaw] = deque(maxlen=WAITING)
        self._source, self._epoch_ns = "", 0
        self._heard = NOTHING_HEARD
        self._learned = Learned()

    def take(self, epoch: GpsRaw, source: str) -> None:
        """An epoch of a receiver, which is used once the tick after it has come."""
        if source != self._source:
            if self._source and abs(epoch.t_ns - self._epoch_ns) <= SILENT_NS:
                return
            self._source, self._learned = source, Learned()
        self._epoch_ns = epoch.t_ns
        self._waiting.append(epoch)

    @property
    def is_needed(self) -> bool:
        """Whether there is a satellite to tell of."""
        return bool(self._waiting or self._heard.names)

    def due(self, t_ns: int, motion: AntennaMotion | None) -> tuple[Aiding, ...]:
        """At a tick; nothing while position, heading or speed are unknown, or no satellite is."""
        if motion is None:
            self._waiting.clear()
            return ()
        antenna = antenna_of(motion._replace(height_m=motion.height_m + self.geoid_sep_m))
        self._past.add(t_ns, antenna)
        for epoch in [each for each in self._waiting if each.t_ns <= t_ns]:
            self._waiting.remove(epoch)
            self._use(epoch)
        self._heard = self._heard.at(t_ns)
        return (self._told(t_ns, antenna),) if self._heard.names else ()

    def _use(self, epoch: GpsRaw) -> None:
        t_ns, antenna = epoch.t_ns, self._past.at(epoch.t_ns)
        satellites, drift = placed(epoch), self._learned.drift
        if antenna is None or not satellites or (drift is not None and t_ns <= drift.t_ns):
            return
        heard = heard_of(satellites, t_ns)
        seen = expected(antenna, heard.orbits, t_ns)
        self._learned = learned(self._learned, Epoch(t_ns, satellites, heard, antenna, seen))
        self._heard = self._heard.with_epoch(heard)

    def _told(self, t_ns: int, antenna: Antenna) -> Aiding:
        heard, drift = self._heard, self._learned.drift
        seen = expected(antenna, heard.orbits, t_ns)
        drift_mps, drift_variance = (drift.mps, drift.variance_at(t_ns)) if drift else (0.0, 0.0)
        rates_mps = seen.rates_mps + (drift_mps - heard.clock_drifts_mps)
        age_mps = UNMODELLED_MPS2 * 1e-9 * (t_ns - heard.heard_ns)
        variances = self._learned.doubt.factor * seen.rate_variances + drift_variance + age_mps**2
        rows = zip(
            heard.names,
            seen.ups.tolist(),
            (heard.hz_per_mps * rates_mps).tolist(),
            np.abs(heard.hz_per_mps * np.sqrt(variances)).tolist(),
            (seen.ranges_m - heard.clock_biases_m).tolist(),
            strict=True,
        )
        clocks = self._clocks_at(t_ns, antenna.place_std_m)
        return Aiding(
            t_ns=t_ns,
            satellites=tuple(
                AidedSatellite(
                    system=name[0],
                    prn=name[1],
                    doppler_hz=doppler_hz,
                    doppler_std_hz=std_hz,
                    pseudorange_m=range_m + clocks[name[0]][0] if name[0] in clocks else None,
                    pseudorange_std_m=clocks[name[0]][1] if name[0] in clocks else None,
                )
                for name, up, doppler_hz, std_hz, range_m in rows
                if up > 0.0
            ),
            clock_drift_mps=drift_mps if drift else None,
        )

    def _clocks_at(self, t_ns: int, place_std_m: float) -> dict[str, tuple[float, float]]:
        """By system: what its pseudoranges have on top, and one sigma of a pseudorange."""
        drift = self._learned.drift
        if drift is None:
            return {}
        clocks = {}
        for system, offset in self._learned.offsets.items():
            after_s = (t_ns - offset.t_ns) * 1e-9
            walked = walked_m(math.sqrt(drift.variance), after_s)
            variance = offset.variance + walked**2 + place_std_m**2
            clocks[system] = (offset.metres + drift.mps * after_s, math.sqrt(variance))
        return clocks
