"""Each position keeps the time that was told with it, in whatever order sentences come."""

import datetime as dt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unit.gps_ingest.receiver import fixes, flush, gga, gsa, hear, line, rmc
from wayline.messages import GpsFix
from wayline_gps_ingest.core import GpsIngestCore

NOON_NS = 764_424_000 * 10**9
"""1994-03-23, the day of `rmc`."""


def position(step: int) -> str:
    return f"48{step // 100:02d}.{step % 100:02d}0,N,01131.000,E"


def time(step: int, rate_hz: int) -> str:
    milliseconds = step * 1000 // rate_hz
    return (
        f"12{milliseconds // 60_000:02d}{milliseconds // 1000 % 60:02d}.{milliseconds % 1000:03d}"
    )


def sentences(steps: int, rate_hz: int) -> list[tuple[int, str]]:
    return [
        (step, sentence)
        for step in range(steps)
        for sentence in (
            rmc(time(step, rate_hz), position=position(step)),
            gga(time(step, rate_hz), position=position(step)),
        )
    ]


def step_of(fix: GpsFix) -> float:
    """Which step's position a fix has."""
    assert fix.lat_deg is not None
    return (fix.lat_deg - 48.0) * 6000.0


@given(st.sampled_from([1, 2, 4, 5, 10]), st.lists(st.integers(0, 20), min_size=60, max_size=60))
def test_no_position_gets_another_time_when_sentences_are_up_to_two_seconds_late(
    rate_hz: int, delays: list[int]
) -> None:
    """Delays of up to 2 s in tenths; what comes too late is left out and counted."""
    told = sentences(30, rate_hz)
    sent = sorted(
        zip(told, delays, strict=True), key=lambda each: each[0][0] * 10 + each[1] * rate_hz
    )
    core = GpsIngestCore()
    out = fixes(hear(core, [text for (_, text), _ in sent])) + fixes(flush(core))
    for fix in out:
        assert fix.valid
        assert fix.t_ns == NOON_NS + round(step_of(fix)) * 10**9 // rate_hz
    assert "clock" not in core.faults
    assert sum(core.faults.values()) >= 30 - len(out)


@given(st.integers(2, 27))
def test_an_epoch_that_interrupts_an_open_one_costs_neither(late: int) -> None:
    """RMC of the later one, both of the earlier one, GGA of the later one."""
    told = sentences(30, 4)
    texts = [text for _, text in told]
    first = 2 * late
    texts[first : first + 4] = [texts[first + at] for at in (2, 0, 1, 3)]
    core = GpsIngestCore()
    out = fixes(hear(core, texts)) + fixes(flush(core))
    assert [round(step_of(fix)) for fix in out] == list(range(30))
    assert all(fix.alt_m is not None and fix.speed_mps is not None for fix in out)
    assert core.bad_input == 0


def zda(time: str, date: str = "23,03,1994") -> str:
    return line(f"GPZDA,{time},{date},00,00")


def epochs(cycle: list[str], seconds: int = 10) -> tuple[list[GpsFix], dict[str, int]]:
    """Cycles of sentences with {} for the second of each time."""
    core = GpsIngestCore()
    out = []
    for second in range(seconds):
        texts = [text.format(f"{second:02d}") for text in cycle]
        out += fixes(hear(core, [line(text) for text in texts]))
    return out + fixes(flush(core)), core.faults


PLACE = "4807.038,N,01131.000,E"
GGA = f"GPGGA,1200{{}}.00,{PLACE},1,08,0.9,545.4,M,46.9,M,,"
RMC = f"GPRMC,1200{{}}.00,A,{PLACE},022.4,084.4,230394,003.1,W"
GSA = "GPGSA,A,3,04,05,,09,12,,,24,,,,,2.5,1.3,2.1"
GST = "GPGST,1200{}.50,5.0,,,,3.0,4.0,7.5"


@pytest.mark.parametrize(
    "cycle",
    [
        [GGA, "GPZDA,1200{}.02,23,03,1994,,", RMC, GSA],
        [GGA, RMC, GSA, "GPZDA,1200{}.41,23,03,1994,,"],
        [GGA, RMC, "GPZDA,1200{}.97,23,03,1994,,", GSA],
        ["GPZDA,1200{}.30,23,03,1994,,", GGA, RMC, GSA],
        ["GPZDA,1200{}.00,23,03,1994,,", GGA, RMC, GSA],
        [GGA, "GPGST,1200{}.04,5.0,,,,3.0,4.0,7.5", RMC, GSA],
        [GGA.replace("{}.00", "{}.40"), RMC.replace("{}.00", "{}"), GSA],
        [RMC.replace("{}.00", "{}"), GGA.replace("{}.00", "{}.40"), GSA],
    ],
)
def test_a_sentence_with_a_time_of_its_own_splits_no_epoch(cycle: list[str]) -> None:
    """ZDA and GST stamped when they were sent; an RMC whose decimals were cut off."""
    out, faults = epochs(cycle)
    assert faults == {}
    assert len(out) == 10
    assert [fix.t_ns - out[0].t_ns for fix in out] == [n * 10**9 for n in range(10)]
    for fix in out[1:]:
        assert (fix.speed_derived, fix.course_deg, fix.alt_m, fix.pdop) == (False, 84.4, 545.4, 2.5)


def test_a_zda_in_the_middle_does_not_hold_the_fix_back() -> None:
    """Once the cycle is known, its last sentence publishes it."""
    core = GpsIngestCore()
    for second in range(5):
        now = f"1200{second:02d}"
        hear(core, [gga(now), zda(f"{now}.02"), rmc(now), gsa()])
    assert fixes(hear(core, [gga("120005"), zda("120005.02"), rmc("120005")])) == []
    assert len(fixes(hear(core, [gsa()]))) == 1


def test_a_zda_sent_after_midnight_dates_its_epoch_before_it() -> None:
    core = GpsIngestCore()
    texts = [gga("235958.90"), gga("235959.90"), zda("000000.05", "24,03,1994"), gga("000000.90")]
    out = fixes(hear(core, texts)) + fixes(flush(core))
    before = dt.datetime(1994, 3, 23, 23, 59, 59, 900_000, dt.UTC).timestamp()
    assert [fix.t_ns / 1e9 - before for fix in out] == pytest.approx([-1.0, 0.0, 1.0], abs=1e-3)
