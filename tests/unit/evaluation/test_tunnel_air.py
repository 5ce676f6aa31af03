import numpy as np
import pytest

from unit.simulator.journeys import cruise
from wayline_evaluation.tunnel_air import piston_pa
from wayline_simulator.barometer import BarometerModel, tunnel_pressure_pa
from wayline_simulator.course import Surroundings
from wayline_simulator.happenings import Change, Happenings

SPEED_MPS = 30.0


def test_it_is_what_the_simulated_barometer_feels() -> None:
    """Two tunnels at 30 m/s: the simulator's own pressure to a thousandth of a pascal."""
    model, journey = BarometerModel(), cruise(SPEED_MPS, 60.0)
    times_s = 0.3 + np.arange(119) / model.rate_hz
    changes = [(0.0, 0), (10.1, 5), (20.2, 0), (25.4, 1), (30.0, 5), (33.3, 0)]
    begins_s = np.array([time_s for time_s, _ in changes])
    kinds = np.array([kind for _, kind in changes], dtype=np.int8)
    surroundings = kinds[np.searchsorted(begins_s, times_s, "right") - 1]
    truth = journey.at(times_s)._replace(surroundings=surroundings)
    happened = Happenings(surroundings=tuple(Change(*change) for change in changes))
    told_pa = piston_pa(times_s, np.full(len(times_s), SPEED_MPS), happened, model)
    assert np.abs(told_pa).max() > 80.0
    assert told_pa == pytest.approx(tunnel_pressure_pa(truth, model), abs=1e-3)


def test_a_bridge_is_no_tunnel() -> None:
    """Too short to push air before oneself."""
    happened = Happenings(surroundings=(Change(0.0, 0), Change(5.0, Surroundings.BRIDGE)))
    times_s = np.arange(20.0)
    felt_pa = piston_pa(times_s, np.full(20, SPEED_MPS), happened, BarometerModel())
    assert not felt_pa.any()
