import dataclasses

import numpy as np
import pytest

from unit.simulator.journeys import WHEEL_RADIUS_M, cruise
from wayline_simulator.course import Surroundings
from wayline_simulator.gps_events import DisplacedFixes, GpsEvents
from wayline_simulator.happenings import Happenings, happenings
from wayline_simulator.journey import MOTION_STEP_S, Floats

START_S = 1_767_250_800.0
SPEED_MPS = 10.0


def drive(factor: Floats | float = 1.0, events: GpsEvents | None = None) -> Happenings:
    """200 s at 10 m/s whose wheels turn by a factor too fast, one every MOTION_STEP_S."""
    steady = cruise(SPEED_MPS, 200.0)
    motion = dataclasses.replace(steady.motion, wheel_radps=steady.motion.wheel_radps * factor)
    journey = dataclasses.replace(steady, motion=motion)
    return happenings(journey, events or GpsEvents(), START_S, WHEEL_RADIUS_M)


def seconds() -> Floats:
    return np.asarray(np.arange(round(200.0 / MOTION_STEP_S) + 1) * MOTION_STEP_S)


def test_wheels_that_lock_are_told() -> None:
    """Half a second of zeros, and nothing of the 1 % by which driven wheels always slip."""
    locked = (seconds() > 99.99) & (seconds() < 100.49)
    told = drive(np.where(locked, 0.0, 1.01))
    assert [tuple(span) for span in told.slips] == [
        pytest.approx((START_S + 100.0, START_S + 100.5), abs=1e-3)
    ]


def test_slip_is_told_by_its_spread_and_how_long_it_lasts() -> None:
    """One percent by turns of 20 s: std 1 %, correlated for some 5 s."""
    told = drive(1.0 + np.where(seconds() % 40.0 < 20.0, 0.01, -0.01))
    assert told.slip_std == pytest.approx(0.01, abs=0.001)
    assert 2.0 < told.slip_time_s < 10.0
    assert not told.slips


def test_surroundings_are_told_by_their_changes() -> None:
    """Open all the way is one entry."""
    told = drive()
    assert [change.surroundings for change in told.surroundings] == [Surroundings.OPEN]
    assert told.surroundings[0].time_s == START_S


def test_fixes_that_an_event_moves_are_told() -> None:
    """By their timestamps."""
    event = DisplacedFixes(start_s=50.0, length_s=1.0, east_m=5.0)
    told = drive(events=GpsEvents(displacements=(event,)))
    assert [tuple(span) for span in told.displaced] == [
        pytest.approx((START_S + 50.0, START_S + 51.0), abs=1e-3)
    ]
