"""The gyro's angle between any two instants."""

import pytest

from builders import at
from wayline_fusion.filter.gyro_track import GyroTrack


def track(*samples: tuple[float, float]) -> GyroTrack:
    built = GyroTrack()
    for seconds, rate_radps in samples:
        built.add(at(seconds), rate_radps)
    return built


def test_a_ramp_is_integrated_exactly() -> None:
    built = track(*((0.1 * step, 0.1 * step) for step in range(11)))
    assert built.turned_rad(at(0.0), at(1.0)) == pytest.approx(0.5)
    assert built.turned_rad(at(0.2), at(0.4)) == pytest.approx(0.06)


def test_the_last_rate_is_held_for_a_second_and_then_unknown() -> None:
    built = track((0.0, 0.5))
    assert built.turned_rad(at(0.0), at(1.0)) == pytest.approx(0.5)
    assert built.turned_rad(at(0.0), at(1.1)) is None
    assert built.rate_radps(at(0.9)) == 0.5
    assert built.rate_radps(at(1.1)) is None


def test_within_a_gap_the_rate_is_unknown_once_it_was_held_too_long() -> None:
    built = track((0.0, 0.5), (5.0, 0.5))
    assert built.rate_radps(at(3.0)) is None
    assert built.rate_radps(at(5.5)) == 0.5


def test_repeated_and_disordered_samples_change_nothing() -> None:
    built = track((0.0, 0.5), (0.1, 0.5), (0.1, 9.0), (0.05, 9.0))
    assert built.turned_rad(at(0.0), at(0.1)) == pytest.approx(0.05)


def test_memory_is_bounded() -> None:
    built = track(*((0.01 * step, 1.0) for step in range(10_000)))
    assert len(built._times_ns) < 3_000
    assert built.turned_rad(at(98.0), at(99.0)) == pytest.approx(1.0)
