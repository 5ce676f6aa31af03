"""A vehicle that drives more slowly than usual goes on so for a while."""

import numpy as np
import pytest

from unit.eta.route_drives import SECOND_NS, START_NS, Metres, follow, poses, route_of
from wayline.tuning import Tuning
from wayline_eta.core import EtaCore
from wayline_eta.own_pace import OwnPace

LINE: list[Metres] = [(0, 0), (9000, 0)]
FREE_S, JAM_S = 100, 1_200


@pytest.mark.parametrize("every_m", [400.0, 800.0, 1500.0])
@pytest.mark.parametrize("planned_mps", [10.0, 8.3])
def test_a_jam_is_told_from_five_minutes_on(every_m: float, planned_mps: float) -> None:
    """At 3 m/s where more are planned, over several stops, to the end."""
    stops_m = np.arange(every_m, 9_000.0, every_m)
    speeds_mps = [planned_mps] * FREE_S + [3.0] * JAM_S
    came_s = np.searchsorted(np.cumsum(speeds_mps), stops_m)
    told = follow(
        EtaCore([route_of(LINE, stops_m=stops_m.tolist(), speed_mps=planned_mps)], Tuning()),
        poses(LINE, speeds_mps, noise_m=1.0),
    )
    errors = []
    for one in told[FREE_S + 300 :]:
        stop = one.arrivals.stops[0]
        second = one.arrivals.t_ns / SECOND_NS - START_NS / SECOND_NS
        at = int(stop.stop_id[1:])
        left_s = came_s[at] - second
        if left_s > 20.0 and came_s[at] < len(speeds_mps):
            errors.append(
                (stop.arrival_ns / SECOND_NS - START_NS / SECOND_NS - came_s[at]) / left_s
            )
    assert len(errors) > 200
    assert np.mean(np.abs(errors) < 0.25) > 0.9


def test_stands_and_a_quick_start_are_no_pace() -> None:
    pace = OwnPace()
    for second in range(100):
        pace.see(1.0 if second % 2 else 0.0, second * SECOND_NS, drives=bool(second % 2))
    assert pace.slower == 1.0
    for second in range(100, 200):
        pace.see(2.0, second * SECOND_NS, drives=True)
    assert pace.slower == 1.0
    for second in range(200, 500):
        pace.see(0.5, second * SECOND_NS, drives=True)
    assert 1.3 < pace.slower < 2.0
