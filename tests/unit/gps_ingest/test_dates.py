"""Days come from the receiver or the drive file, never from today, and time does not go back."""

import datetime as dt
from itertools import accumulate, pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unit.gps_ingest.receiver import fixes, flush, gga, hear, line, rmc
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.dates import SECOND_NS
from wayline_gps_ingest.onward_clock import OnwardClock


def instant_ns(text: str) -> int:
    return round(dt.datetime.fromisoformat(f"{text}+00:00").timestamp()) * SECOND_NS


def test_gga_before_the_first_rmc_waits_for_its_date() -> None:
    core = GpsIngestCore()
    assert hear(core, [gga("120000"), gga("120001")]) == []
    out = fixes(hear(core, [rmc("120001")]) + flush(core))
    assert [fix.t_ns for fix in out] == [
        instant_ns("1994-03-23 12:00:00"),
        instant_ns("1994-03-23 12:00:01"),
    ]
    assert core.bad_input == 0


def test_fixes_long_before_the_first_date_are_dropped_and_counted() -> None:
    core = GpsIngestCore()
    hear(core, [gga("115900"), gga("115959"), rmc("120000")])
    assert len(fixes(flush(core))) == 2
    assert core.faults == {"undated": 1}


def test_a_log_without_a_date_publishes_nothing_and_says_so() -> None:
    core = GpsIngestCore()
    assert hear(core, [gga("120000"), gga("120001")]) + flush(core) == []
    assert core.undated
    assert core.faults == {"undated": 2}


def test_a_dated_log_is_not_called_undated() -> None:
    core = GpsIngestCore()
    hear(core, [gga("110000"), rmc("120000")])
    flush(core)
    assert core.faults == {"undated": 1}
    assert not core.undated


def test_a_given_date_is_the_day_of_the_first_sentence_and_midnight_is_followed() -> None:
    core = GpsIngestCore(date=dt.date(2011, 4, 30))
    out = fixes(hear(core, [gga("235959"), gga("000000"), gga("000001")]) + flush(core))
    assert [fix.t_ns for fix in out] == [
        instant_ns("2011-04-30 23:59:59"),
        instant_ns("2011-05-01 00:00:00"),
        instant_ns("2011-05-01 00:00:01"),
    ]


def test_gga_after_midnight_is_the_next_day_before_rmc_says_so() -> None:
    core = GpsIngestCore()
    out = fixes(hear(core, [rmc("235959"), gga("000000"), gga("000001")]) + flush(core))
    assert out[-1].t_ns == instant_ns("1994-03-24 00:00:01")


def test_latency_moves_a_fix_to_when_it_was_measured() -> None:
    core = GpsIngestCore(gps_latency_s=0.25)
    (fix,) = fixes(hear(core, [rmc("120000")]) + flush(core))
    assert fix.t_ns == instant_ns("1994-03-23 12:00:00") - 250_000_000


def test_the_clock_of_a_receiver_without_a_fix_is_not_believed_against_a_fix() -> None:
    """Cold receivers tell dates decades off; recorded in gpsd's gp-320fw coldboot log."""
    core = GpsIngestCore()
    cold = [
        rmc(f"0004{second}", status="V", date="220899", position=",,,") for second in range(25, 35)
    ]
    out = fixes(hear(core, [*cold, rmc("120000", date="070419"), rmc("120001", date="070419")]))
    out += fixes(flush(core))
    assert [fix.t_ns for fix in out] == [
        instant_ns("2019-04-07 12:00:00"),
        instant_ns("2019-04-07 12:00:01"),
    ]
    assert core.bad_input == 0


def test_a_log_that_never_has_a_fix_is_published_with_its_own_dates() -> None:
    core = GpsIngestCore()
    out = fixes(hear(core, [rmc("120000", status="V"), rmc("120001", status="V")]) + flush(core))
    assert [(fix.valid, fix.t_ns) for fix in out] == [
        (False, instant_ns("1994-03-23 12:00:00")),
        (False, instant_ns("1994-03-23 12:00:01")),
    ]


def test_a_leap_second_learned_steps_back_without_an_output_going_back() -> None:
    """Recorded in munich.nmea at 12:43:42: every fix goes out, none after the step is ahead."""
    core = GpsIngestCore()
    times = ("124341", "124342", "124341", "124342", "124343", "124344")
    out = fixes(hear(core, [rmc(time) for time in times]) + flush(core))
    seconds = [fix.t_ns / SECOND_NS % 60 for fix in out]
    assert seconds == pytest.approx([41, 42, 42 + 1 / 3, 42 + 2 / 3, 43, 44], abs=1e-6)
    assert core.faults == {"clock": 2}


def test_one_corrupt_date_does_not_move_time_ahead() -> None:
    core = GpsIngestCore()
    texts = [rmc("120000"), rmc("120001", date="230375"), rmc("120002"), rmc("120003")]
    out = fixes(hear(core, texts) + flush(core))
    assert [fix.t_ns // SECOND_NS % 60 for fix in out] == [0, 2, 3]
    assert core.faults == {"clock": 1}


def test_a_clock_that_goes_on_after_a_pause_is_followed() -> None:
    clock = OnwardClock()
    year_ns = 365 * 86_400 * SECOND_NS
    instants = [0, year_ns, year_ns + SECOND_NS]
    assert [clock.fixed_ns(each) for each in instants] == instants


def test_a_clock_that_steps_far_back_is_moved_on_until_it_returns() -> None:
    clock = OnwardClock()
    hour_ns = 3600 * SECOND_NS
    raw = (hour_ns, 0, SECOND_NS, hour_ns + 10 * SECOND_NS)
    assert [clock.fixed_ns(each) for each in raw] == [
        hour_ns,
        hour_ns + SECOND_NS,
        hour_ns + 2 * SECOND_NS,
        hour_ns + 10 * SECOND_NS,
    ]
    assert clock.faults == 2


@given(
    st.lists(st.integers(1, 30), min_size=1, max_size=20),
    st.integers(1, 200),
    st.lists(st.integers(1, 30), max_size=300),
)
def test_a_small_step_back_keeps_every_fix_in_order_and_is_caught_up(
    before: list[int], back: int, after: list[int]
) -> None:
    """Tenths of seconds: whatever the rates and the step, instants rise, and end as the clock's."""
    tenth_ns = SECOND_NS // 10
    raw = [10**9, *accumulate(before, initial=10**9 + 1)]
    raw += list(accumulate(after, initial=raw[-1] - back))
    clock = OnwardClock()
    out = [clock.fixed_ns(tenths * tenth_ns) for tenths in raw]
    told = [t_ns for t_ns in out if t_ns is not None]
    assert len(told) >= len(raw) - 1  # the very instant told before is not told again
    assert all(first < second for first, second in pairwise(told))
    if raw[-1] * tenth_ns >= max(raw[: len(before) + 2]) * tenth_ns + SECOND_NS:
        assert out[-1] == raw[-1] * tenth_ns


@pytest.mark.parametrize("raw_ns", [-1, 0, 3601 * SECOND_NS])
def test_an_epoch_without_a_fix_never_moves_time_far(raw_ns: int) -> None:
    clock = OnwardClock()
    clock.fixed_ns(0)
    assert clock.unfixed_ns(raw_ns) is None


def test_zda_dates_a_receiver_without_rmc() -> None:
    core = GpsIngestCore()
    zda = line("GPZDA,120000,04,07,2012,,")
    (fix,) = fixes(hear(core, [gga("120000"), zda]) + flush(core))
    assert fix.t_ns == instant_ns("2012-07-04 12:00:00")


ERA = dt.timedelta(weeks=1024)
MONDAY = dt.date(2026, 11, 23)


def test_a_week_counter_that_rolled_over_is_put_right_by_the_time_of_arrival() -> None:
    core = GpsIngestCore()
    date = f"{MONDAY - ERA:%d%m%y}"
    out = fixes(hear(core, [rmc("120000", date=date)], instant_ns("2026-11-23 12:00:00") + 5))
    assert [fix.t_ns for fix in out + fixes(flush(core))] == [instant_ns("2026-11-23 12:00:00")]
    assert core.bad_input == 0


@pytest.mark.parametrize("arrival", ["2026-11-25 12:00:00", "1970-01-01 00:00:00"])
def test_a_date_that_is_not_whole_eras_old_is_believed(arrival: str) -> None:
    """An old log played today, and a computer that does not know the time."""
    core = GpsIngestCore()
    date = MONDAY - ERA
    hear(core, [rmc("120000", date=f"{date:%d%m%y}")], instant_ns(arrival))
    (fix,) = fixes(flush(core))
    assert fix.t_ns == instant_ns(f"{date} 12:00:00")


def test_a_week_counter_that_rolls_over_in_the_middle_of_a_log_is_followed() -> None:
    """As on 2019-04-06 at 23:59:42, the second end of a GPS era."""
    core = GpsIngestCore()
    texts = [rmc("235941", date="060419"), rmc("235942", date="060419")]
    texts += [rmc("235943", date="210899"), rmc("235944", date="210899")]
    out = fixes(hear(core, texts) + flush(core))
    assert [fix.t_ns - out[0].t_ns for fix in out] == [n * SECOND_NS for n in range(4)]
    assert core.bad_input == 0


AHEAD = [
    {"time": "130001"},
    {"time": "120001", "date": "230346"},
    {"time": "120001", "date": f"{dt.date(1994, 3, 23) + ERA:%d%m%y}"},
]
"""The second after noon, an hour, 52 years or an era of GPS weeks ahead."""


def told(core: GpsIngestCore, texts: list[str]) -> list[int]:
    out = fixes(hear(core, texts)) + fixes(flush(core))
    return [(fix.t_ns - instant_ns("1994-03-23 12:00:00")) // SECOND_NS for fix in out]


@pytest.mark.parametrize("recorded", [False, True])
@pytest.mark.parametrize("wrong", AHEAD)
def test_epochs_ahead_that_do_not_last_are_dropped(wrong: dict[str, str], recorded: bool) -> None:
    """A few seconds of nonsense; the receiver's later dates are not measured by it."""
    core = GpsIngestCore(recorded=recorded)
    texts = [rmc("120000"), rmc(**wrong), *(rmc(f"1200{s:02d}") for s in range(2, 30))]
    assert told(core, texts) == [0, *range(2, 30)]
    assert core.faults == {"clock": 1}


def test_a_recording_that_begins_ahead_begins_with_what_lasts() -> None:
    core = GpsIngestCore(recorded=True)
    wrong = [rmc(f"1300{second:02d}") for second in range(9)]
    right = [rmc(f"1200{second:02d}") for second in range(9, 30)]
    assert told(core, wrong + right) == list(range(9, 30))
    assert core.faults == {"clock": 9}


def test_a_pause_of_hours_costs_no_fix() -> None:
    core = GpsIngestCore(recorded=True)
    texts = [rmc(f"{hour}00{second:02d}") for hour in (12, 17) for second in range(20)]
    assert told(core, texts) == [hour * 3600 + second for hour in (0, 5) for second in range(20)]
    assert core.bad_input == 0


def test_an_era_ahead_for_good_is_followed_once_ten_agree() -> None:
    core = GpsIngestCore()
    date = f"{dt.date(1994, 3, 23) + ERA:%d%m%y}"
    texts = [rmc("120000"), *(rmc(f"1200{s:02d}", date=date) for s in range(1, 12))]
    era_s = int(ERA.total_seconds())
    assert told(core, texts) == [0, *(era_s + second for second in range(1, 12))]
    assert core.bad_input == 0


def test_a_live_receiver_that_begins_ahead_of_the_host_waits() -> None:
    core = GpsIngestCore(clock_from_ns=instant_ns("1994-01-01 00:00:00"))
    now_ns = instant_ns("1994-03-23 12:00:00")
    assert hear(core, [rmc("130000"), rmc("130001"), rmc("130002")], now_ns) == []
    out = fixes(hear(core, [rmc("120003"), rmc("120004")], now_ns + 3 * SECOND_NS))
    assert [fix.t_ns for fix in out] == [now_ns + second * SECOND_NS for second in (3, 4)]


def test_a_host_that_does_not_know_the_time_delays_no_receiver() -> None:
    core = GpsIngestCore(clock_from_ns=instant_ns("1994-01-01 00:00:00"))
    out = hear(core, [rmc("120000"), rmc("120001")], instant_ns("1970-01-01 00:00:07"))
    assert [fix.t_ns for fix in fixes(out)] == [instant_ns("1994-03-23 12:00:00")]
