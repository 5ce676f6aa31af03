"""The wheels' noise is no less than the steps that their speed is told in."""

import math

import pytest

from wayline.vertical.wheel_noise import WheelNoise

KMH_MPS = 1.0 / 3.6


def noise_of(speeds_mps: list[float]) -> WheelNoise:
    """After readings twice a second."""
    noise = WheelNoise(held_s=1.0, slowest_mps=4.0)
    for number, speed_mps in enumerate(speeds_mps):
        noise.learn(number * 500_000_000, speed_mps)
    return noise


@pytest.mark.parametrize("step_mps", [KMH_MPS, KMH_MPS / 4.0, 0.1])
def test_steps_of_the_bus_are_found_whatever_their_unit(step_mps: float) -> None:
    """A mean of many readings that share a step is no better than the step."""
    speeds_mps = [step_mps * round(20.0 / step_mps + number % 7) for number in range(40)]
    least_mps = min(step_mps / math.sqrt(12.0), 0.08)
    assert noise_of(speeds_mps).std_mps(1000) == pytest.approx(least_mps, rel=0.01)


def test_a_scale_written_with_seven_digits_is_whole_kmh_as_well() -> None:
    speeds_mps = [0.2777778 * kmh for kmh in (71, 72, 73, 74, 72, 88, 89, 88)]
    assert noise_of(speeds_mps).std_mps(1000) == pytest.approx(0.08)


def test_fine_steps_are_no_noise() -> None:
    speeds_mps = [20.0 + 0.00137 * number for number in range(40)]
    assert noise_of(speeds_mps).std_mps() < 0.002
