"""A vehicle's distance counter: wraps, restarts and second units."""

import pytest

from builders import at
from wayline_can_ingest.counter import Unwrapped


def distances(span_m: float, *readings: tuple[float, float]) -> list[float | None]:
    """Of one unit's readings, each with its time in seconds."""
    counter = Unwrapped(span_m)
    return [counter.distance_m(counted, at(seconds), 0) for seconds, counted in readings]


@pytest.mark.parametrize("bits", [16, 32])
def test_a_wrap_is_taken_out(bits: int) -> None:
    """From the end of the count to its start it goes on, at any width."""
    span_m = 2.0**bits * 5.0
    told = distances(span_m, (0, span_m - 10.0), (1, 5.0), (2, 30.0))
    assert told == [span_m - 10.0, span_m + 5.0, span_m + 30.0]


def test_two_wraps_add_up() -> None:
    """Each wrap counts once."""
    told = distances(1000.0, (0, 990.0), (1, 10.0), (30, 990.0), (31, 10.0))
    assert told == [990.0, 1010.0, 1990.0, 2010.0]


def test_a_restart_is_no_wrap() -> None:
    """A fall to 0 that nobody can have driven holds the distance, and counting goes on."""
    told = distances(6553.6, (0, 3000.0), (1, 0.0), (2, 20.0))
    assert told == [3000.0, 3000.0, 3020.0]


def test_a_small_fall_is_no_wrap() -> None:
    """A vehicle that rolls back may count down; the distance never does."""
    assert distances(6553.6, (0, 3000.0), (1, 2999.0), (2, 3001.0)) == [3000.0, 3000.0, 3002.0]


def test_a_late_memory_is_believed() -> None:
    """A unit that has read its memory late jumps up to the right count."""
    assert distances(2.0**32 * 5.0, (0, 37_500.0), (1, 1.0e8)) == [37_500.0, 1.0e8]


def test_a_late_memory_after_a_restart_is_believed_too() -> None:
    """The count itself then, without what the unit said before it restarted."""
    told = distances(2.0**32 * 5.0, (0, 37_500.0), (1, 0.0), (1.4, 158_910_600.0))
    assert told == [37_500.0, 37_500.0, 158_910_600.0]


def test_one_unit_is_read_until_it_is_silent() -> None:
    """A second unit with another count is left out, and takes over when the first has gone."""
    counter = Unwrapped(1.0e6)
    assert counter.distance_m(100.0, at(0), 1) == 100.0
    assert counter.distance_m(900.0, at(1), 2) is None
    assert counter.distance_m(120.0, at(2), 1) == 120.0
    assert counter.distance_m(900.0, at(30), 2) == 900.0
