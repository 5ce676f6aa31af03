"""What telling a receiver's loops costs beside bare filterpy."""

import math
from collections.abc import Iterator
from functools import partial
from itertools import islice

import numpy as np

from wayline.messages import GpsRaw, RawSatellite
from wayline.satellites.doppler import TO_ECEF
from wayline.tuning import Tuning
from wayline_bench.bare_filter import BareFilter
from wayline_bench.made_up_drive import ORIGIN, drive, with_ticks
from wayline_bench.rounds import Say, Work, in_turns
from wayline_bench.row import Row, compared
from wayline_fusion.core import FusionCore

SATELLITES = 12
AWAY_M, SPEED_MPS = 2.2e7, 3e3
WARM_UP = 3_000
"""Inputs: half a minute of sensors."""
ROUNDS, MESSAGES = 15, 500
STEP_NS, MESSAGES_A_SECOND = 100_000_000, 10
STEPS_ALLOWED = 5.0


def aiding_row(say: Say, start_ns: int) -> Row:
    """One message, from the state of the filter on."""
    aided = Aided(start_ns)
    works: dict[str, Work] = {
        "one": partial(BareFilter().steps, MESSAGES, 1),
        "aiding": aided.messages,
    }
    spent_s = in_turns(works, ROUNDS, lambda progress: say(f"aiding: {progress}"))
    us = {work: [each * 1e6 / MESSAGES for each in rounds] for work, rounds in spent_s.items()}
    what = f"aiding of {SATELLITES} satellites"
    yardstick = "filterpy predict, update"
    return compared(
        what, us["aiding"], us["one"], yardstick, unit="us a message", bar=STEPS_ALLOWED
    )


class Aided:
    """A core that hears an epoch a second; the vehicle's motion stays as it is."""

    def __init__(self, start_ns: int) -> None:
        self._core = core = FusionCore(Tuning())
        for each in islice(with_ticks(drive(start_ns, 0)), WARM_UP):
            core.handle(each, "bench")
        self._t_ns = start_ns + WARM_UP * STEP_NS
        self._satellites = tuple(_satellites())

    def messages(self) -> None:
        """A round of them: what a tick costs more where satellites are known."""
        core = self._core
        for number in range(MESSAGES):
            if number % MESSAGES_A_SECOND == 0:
                core.handle(GpsRaw(t_ns=self._t_ns, satellites=self._satellites), "bench")
            self._t_ns += STEP_NS
            core._aider.due(self._t_ns, core._outputs.carried())


def _satellites() -> Iterator[RawSatellite]:
    """In a ring about the zenith."""
    here_m = np.array(TO_ECEF.transform(ORIGIN.lon_deg, ORIGIN.lat_deg, 0.0))
    up = here_m / np.linalg.norm(here_m)
    side = np.cross(up, (0.0, 0.0, 1.0))
    side /= np.linalg.norm(side)
    for number in range(SATELLITES):
        turn_rad = 2.0 * math.pi * number / SATELLITES
        beside = math.cos(turn_rad) * side + math.sin(turn_rad) * np.cross(up, side)
        x_m, y_m, z_m = (here_m + AWAY_M * math.sqrt(0.5) * (up + beside)).tolist()
        vx_mps, vy_mps, vz_mps = (SPEED_MPS * np.cross(up, beside)).tolist()
        yield RawSatellite(
            system="gps",
            prn=number + 1,
            doppler_hz=100.0 * number,
            pseudorange_m=AWAY_M,
            x_m=x_m,
            y_m=y_m,
            z_m=z_m,
            vx_mps=vx_mps,
            vy_mps=vy_mps,
            vz_mps=vz_mps,
        )
