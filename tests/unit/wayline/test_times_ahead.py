"""Times far ahead are held until enough agree: what does not last costs itself and nothing else."""

from itertools import accumulate

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from wayline.times_ahead import AGREEING, SECOND_NS, TimesAhead, believed

START_NS = 1_700_000_000 * SECOND_NS
HOUR_NS = 3_600 * SECOND_NS
ERA_NS = 1_024 * 7 * 24 * HOUR_NS
YEARS_NS = 20 * 365 * 24 * HOUR_NS
LEAPS_NS = (120 * SECOND_NS, HOUR_NS, ERA_NS, YEARS_NS)


def kept(times_ns: list[int], *, doubts_start: bool) -> tuple[list[int], int]:
    """Times that are told of a whole recording, and how many are not."""
    ahead = TimesAhead[int](doubts_start=doubts_start)
    told = list(believed(((t_ns, t_ns) for t_ns in times_ns), ahead))
    return told, ahead.dropped


def regular(count: int, period_ns: int = SECOND_NS) -> list[int]:
    return [START_NS + number * period_ns for number in range(count)]


@settings(deadline=None)
@given(
    st.sampled_from([SECOND_NS // 10, SECOND_NS // 4, SECOND_NS, 30 * SECOND_NS, 120 * SECOND_NS]),
    st.integers(0, 150),
    st.integers(1, AGREEING - 1),
    st.sampled_from(LEAPS_NS[1:]),
)
def test_a_recording_loses_what_was_ahead_and_nothing_else(
    period_ns: int, at: int, wrong: int, leap_ns: int
) -> None:
    """At the start, in the middle and at the end, at any rate.

    A single report at the very end, after so many that were wrong, is not enough to be believed.
    """
    assume(at + wrong != 149)
    right = regular(150, period_ns)
    times_ns = [
        t_ns + (leap_ns if at <= number < at + wrong else 0) for number, t_ns in enumerate(right)
    ]
    told, dropped = kept(times_ns, doubts_start=True)
    assert told == [t_ns for t_ns in right if t_ns in set(times_ns)]
    assert dropped == min(wrong, max(150 - at, 0))


@pytest.mark.parametrize("doubts_start", [False, True])
@pytest.mark.parametrize("leap_ns", LEAPS_NS)
def test_a_pause_costs_nothing(leap_ns: int, doubts_start: bool) -> None:
    before = regular(20)
    after = [t_ns + leap_ns for t_ns in regular(40)[20:]]
    assert kept(before + after, doubts_start=doubts_start) == (before + after, 0)


def test_pauses_in_a_row_cost_nothing() -> None:
    """Few reports between them: they wait for the ones that follow."""
    times_ns = [
        t_ns + pause * HOUR_NS for pause in range(4) for t_ns in regular(5 if pause < 3 else 30)
    ]
    assert kept(times_ns, doubts_start=False) == (times_ns, 0)


@given(
    st.sampled_from([5, 15, 30, 60, 120]), st.lists(st.sampled_from([0.8, 1.0, 2.0]), min_size=30)
)
def test_seldom_reports_are_not_ahead_of_each_other(usual_s: int, shares: list[float]) -> None:
    """From the second report on, and when one is missing."""
    ahead = TimesAhead[int]()
    seconds = accumulate([0.0, 1.0, 1.0, 1.0, *shares])
    for t_ns in [START_NS + round(usual_s * each) * SECOND_NS for each in seconds]:
        assert ahead.take(t_ns, t_ns) == [(t_ns, t_ns)]


def test_a_beginning_years_before_the_rest_is_wrong() -> None:
    """A receiver that computes positions before it knows the year."""
    cold = [t_ns - YEARS_NS for t_ns in regular(5)]
    rest = regular(30)[5:]
    assert kept(cold + rest, doubts_start=True) == (rest, 5)


def test_a_short_recording_is_told_as_it_is() -> None:
    assert kept(regular(3), doubts_start=True) == (regular(3), 0)
    assert kept([START_NS, START_NS + 120 * SECOND_NS], doubts_start=True)[1] == 0


def test_after_a_short_break_the_end_is_told_but_not_after_an_hour() -> None:
    """Logs are cut; clocks are wrong by whole hours at least."""
    before = regular(20)
    for minutes, lost in ((5, 0), (20, 0), (60, 3)):
        after = [before[-1] + (minutes * 60 + number) * SECOND_NS for number in range(3)]
        assert kept(before + after, doubts_start=False)[1] == lost


def test_ten_over_less_than_ten_seconds_are_not_enough() -> None:
    ahead = TimesAhead[int]()
    ahead.take(START_NS, 0)
    leap_ns = START_NS + HOUR_NS
    for number in range(100):
        assert ahead.take(leap_ns + number * SECOND_NS // 10, number) == []
    assert len(ahead.take(leap_ns + 10 * SECOND_NS, 100)) == 101


def test_a_receipt_bears_a_time_out_at_once() -> None:
    """A live receiver after an hour in a garage: the host knows how late it is."""
    ahead = TimesAhead[int]()
    ahead.take(START_NS, 0)
    after_ns = START_NS + HOUR_NS
    assert ahead.take(after_ns, 1, after_ns + SECOND_NS) == [(after_ns, 1)]
    assert ahead.dropped == 0


def test_a_receipt_doubts_the_first_time_of_all() -> None:
    ahead = TimesAhead[int]()
    assert ahead.take(START_NS + HOUR_NS, 0, START_NS) == []
    assert ahead.take(START_NS + SECOND_NS, 1, START_NS + SECOND_NS) == [(START_NS + SECOND_NS, 1)]
    assert ahead.dropped == 1


def test_a_vehicle_never_refuses_its_receiver_for_its_own_clock_s_sake() -> None:
    """The host's clock lies a day behind: after ten seconds the receiver is believed."""
    ahead = TimesAhead[int]()
    told = [each for t_ns in regular(20) for each in ahead.take(t_ns, t_ns, t_ns - 24 * HOUR_NS)]
    assert [t_ns for t_ns, _ in told] == regular(20)


def test_a_clock_that_stands_ahead_does_not_fill_memory() -> None:
    ahead = TimesAhead[int](held_max=50)
    ahead.take(START_NS, 0)
    told = [len(ahead.take(START_NS + HOUR_NS, number)) for number in range(50)]
    assert told == [0] * 49 + [50]
