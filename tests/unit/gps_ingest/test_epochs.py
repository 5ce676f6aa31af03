"""Sentences become epochs: each is published once, as soon as it is complete."""

import pytest

from unit.gps_ingest.receiver import POSITION, fixes, flush, gga, gsa, hear, line, rmc
from wayline.inputs import Tick
from wayline_gps_ingest.core import GpsIngestCore


def cycle(time: str) -> list[str]:
    return [rmc(time), gga(time), gsa()]


def settled(core: GpsIngestCore) -> None:
    """A core that has learned the order of `cycle`."""
    for time in ("120000", "120001", "120002"):
        hear(core, cycle(time))


def test_the_learned_last_sentence_publishes_at_once() -> None:
    core = GpsIngestCore()
    settled(core)
    assert hear(core, [rmc("120003"), gga("120003")]) == []
    (fix,) = fixes(hear(core, [gsa()]))
    assert fix.t_ns % 60_000_000_000 == 3_000_000_000


def test_every_epoch_is_published_once_with_all_its_parts() -> None:
    core = GpsIngestCore()
    out = [fix for second in range(20) for fix in fixes(hear(core, cycle(f"1200{second:02d}")))]
    out += fixes(flush(core))
    assert len({fix.t_ns for fix in out}) == len(out) == 20
    assert all(fix.pdop and fix.alt_m and fix.speed_mps for fix in out)


def test_the_next_epoch_closes_one_whose_end_is_not_known() -> None:
    core = GpsIngestCore()
    assert hear(core, cycle("120000")) == []
    (fix,) = fixes(hear(core, [rmc("120001")]))
    assert fix.pdop == 2.5


def test_a_receiver_that_leaves_sentences_out_of_some_cycles_is_not_cut_short() -> None:
    """GSA ends every cycle and stands in the middle of a longer one; recorded in gpsd's iTrek."""
    core = GpsIngestCore()
    out = []
    for second in range(0, 20, 4):
        for short in range(second, second + 3):
            out += fixes(hear(core, [rmc(f"1200{short:02d}"), gsa()]))
        long = f"1200{second + 3:02d}"
        out += fixes(hear(core, [gga(long), gsa(), rmc(long), gsa()]))
    out += fixes(flush(core))
    assert len(out) == 20
    assert all(fix.speed_mps is not None for fix in out)


def test_a_changed_order_is_learned_anew() -> None:
    core = GpsIngestCore()
    settled(core)
    for time in ("120010", "120011", "120012"):
        hear(core, [gga(time), gsa(), rmc(time)])
    assert fixes(hear(core, [gga("120013"), gsa()])) == []
    assert len(fixes(hear(core, [rmc("120013")]))) == 1


def test_each_of_two_cycles_in_turn_is_published_at_its_own_end() -> None:
    """GLL has a time of its own; recorded in gpsd's garmin48 and eXplorist110 logs."""
    core = GpsIngestCore()
    for second in range(0, 8, 2):
        hear(core, cycle(f"1200{second:02d}"))
        hear(core, [line(f"GPGLL,{POSITION},1200{second + 1:02d},A"), line("PGRMZ,48,f,3")])
    assert len(fixes(hear(core, cycle("120008")))) == 1
    assert fixes(hear(core, [line(f"GPGLL,{POSITION},120009,A")])) == []
    assert len(fixes(hear(core, [line("PGRMZ,48,f,3")]))) == 1


def test_a_talker_that_changes_is_known_again_when_it_comes_back() -> None:
    """Recorded in gpsd's nmea-rtk log: GP and GN by turns."""
    core = GpsIngestCore()
    settled(core)
    for time in ("120010", "120011", "120012"):
        hear(core, [line(text[1:-3].replace("GP", "GN")) for text in cycle(time)])
    assert fixes(hear(core, cycle("120020")))[-1].t_ns // 10**9 % 60 == 20


def test_a_cycle_whose_last_sentence_is_missing_is_published_with_the_next() -> None:
    core = GpsIngestCore()
    settled(core)
    assert hear(core, [rmc("120003"), gga("120003")]) == []
    (late,) = fixes(hear(core, [rmc("120004")]))
    assert (late.t_ns // 10**9 % 60, late.alt_m) == (3, 545.4)
    (fix,) = fixes(hear(core, [gga("120004"), gsa()]))
    assert fix.t_ns // 10**9 % 60 == 4


@pytest.mark.parametrize(("waited_ns", "published"), [(999_999_999, 0), (1_000_000_000, 1)])
def test_a_tick_a_second_after_arrival_closes_an_epoch(waited_ns: int, published: int) -> None:
    core = GpsIngestCore()
    received_ns = 764_424_000_300_000_000
    hear(core, cycle("120000"), received_ns)
    assert len(fixes(core.handle(Tick(received_ns + waited_ns), "test"))) == published


def test_without_arrival_times_a_tick_counts_from_the_epoch() -> None:
    core = GpsIngestCore()
    hear(core, cycle("120000"))
    noon_ns = 764_424_000_000_000_000
    assert core.handle(Tick(noon_ns + 900_000_000), "test") == []
    assert len(fixes(core.handle(Tick(noon_ns + 1_000_000_000), "test"))) == 1


def test_what_comes_late_after_a_tick_is_not_a_second_fix() -> None:
    core = GpsIngestCore()
    noon_ns = 764_424_000_000_000_000
    hear(core, [rmc("120000")])
    core.handle(Tick(noon_ns + 2_000_000_000), "test")
    assert fixes(hear(core, [gga("120000"), gsa()]) + flush(core)) == []


def test_a_fix_sent_again_is_a_repeat_and_not_bad() -> None:
    """papers/000: rows with time difference 0."""
    core = GpsIngestCore()
    settled(core)
    first, second, third = fixes(hear(core, cycle("120003") + cycle("120003") + cycle("120003")))
    assert first.valid
    for repeat in (second, third):
        assert (repeat.valid, repeat.repeat, repeat.lat_deg) == (False, True, None)
        assert repeat.t_ns == first.t_ns
    assert core.bad_input == 0


def test_a_receiver_of_one_sentence_repeats_at_once() -> None:
    core = GpsIngestCore()
    out = fixes(hear(core, [rmc(time) for time in ("120000", "120001", "120001", "120001")]))
    assert [fix.repeat for fix in out] == [False, False, True, True]


def test_an_epoch_in_two_bursts_is_one_fix() -> None:
    """RMC comes in both halves of every cycle: no repeat, and what follows it still counts."""
    core = GpsIngestCore()
    out = []
    for second in range(10):
        time = f"1200{second:02d}"
        out += fixes(hear(core, [rmc(time), gga(time), rmc(time), gsa()]))
    out += fixes(flush(core))
    assert [fix.repeat for fix in out] == [False] * 10
    assert all(fix.alt_m is not None and fix.pdop is not None for fix in out)


def test_times_of_different_precision_are_one_instant() -> None:
    core = GpsIngestCore()
    hear(core, [line("GPGLL,3908.8200,N,00023.0832,W,120827.523"), gga("120827.52")])
    (fix,) = fixes(hear(core, [rmc("120827.52")]) + flush(core))
    assert fix.alt_m == 545.4
    assert core.bad_input == 0


def test_a_receiver_that_knows_no_time_ends_the_epoch_and_tells_nothing_else() -> None:
    core = GpsIngestCore()
    hear(core, [rmc("120000"), gga("120000")])
    lost = [line("GPRMC,,V,,,,,,,,,,N"), line("GPGGA,,,,,,0,,,,,,,,")]
    (fix,) = fixes(hear(core, lost * 5) + flush(core))
    assert fix.valid


def test_the_sky_travels_once_a_second_at_any_rate() -> None:
    core = GpsIngestCore()
    messages = []
    for tenth in range(50):
        time = f"1200{tenth // 10:02d}.{tenth % 10}0"
        messages += hear(core, [rmc(time), gga(time), line("GPGSV,1,1,01,07,46,259,26")])
    messages += flush(core)
    assert len(fixes(messages)) == 50
    assert len(messages) - 50 == 5
