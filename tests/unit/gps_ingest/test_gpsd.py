"""gpsd's reports as fixes and skies; the lines are those of gpsd 3.22."""

import pytest

from wayline.inputs import Flush
from wayline.messages import GpsFix, GpsSky, Message
from wayline_gps_ingest.gpsd import GpsdCore, GpsdReport

SECOND_NS = 1_000_000_000
T_NS = 1_796_002_400 * SECOND_NS
"""2026-11-30T01:33:20Z"""
VERSION = '{"class":"VERSION","release":"3.22","rev":"3.22","proto_major":3,"proto_minor":14}'
SKY = (
    '{"class":"SKY","device":"/dev/ttyS1","xdop":0.63,"vdop":1.50,"hdop":1.10,"pdop":1.80,'
    '"nSat":3,"uSat":2,"satellites":['
    '{"PRN":17,"el":72.0,"az":360.0,"ss":32.0,"used":true,"gnssid":0,"svid":17},'
    '{"PRN":66,"el":9.0,"az":75.0,"ss":21.0,"used":true,"gnssid":6,"svid":2},'
    '{"PRN":8,"el":38.0,"az":8.0,"ss":0.0,"used":false}]}'
)
GST = '{"class":"GST","device":"/dev/ttyS1","rms":2.1,"lat":3.0,"lon":4.0,"alt":6.5}'


def tpv(second: int, device: str = "/dev/ttyS1", more: str = '"mode":3,"altMSL":59.8,') -> str:
    return (
        f'{{"class":"TPV","device":"{device}",{more}"time":"2026-11-30T01:33:{second:02d}.000Z",'
        '"lat":-37.784791667,"lon":175.314896667,"epx":9.484,"epy":12.791,"epv":34.5,'
        '"track":181.39,"speed":0.592,"geoidSep":23.7,"eph":20.9}'
    )


def said(core: GpsdCore, *lines: str) -> list[Message]:
    return [message for line in lines for message in core.handle(GpsdReport(1, line), "gps-ingest")]


def fixes(messages: list[Message]) -> list[GpsFix]:
    return [message for message in messages if isinstance(message, GpsFix)]


def test_a_report_is_a_fix_at_once_and_its_vague_errors_are_left_out() -> None:
    """Position, altitude above the sea, motion; eph, epx and epv have no told certainty."""
    core = GpsdCore(gps_latency_s=0.5)
    assert said(core, VERSION, tpv(20)) == [
        GpsFix(
            t_ns=T_NS - SECOND_NS // 2,
            valid=True,
            lat_deg=-37.784791667,
            lon_deg=175.314896667,
            alt_m=59.8,
            geoid_sep_m=23.7,
            speed_mps=0.592,
            course_deg=181.39,
            mode=3,
            fix="gps",
        )
    ]
    assert core.bad_input == 0


def test_sky_and_stds_stand_beside_the_next_fixes_for_ten_seconds() -> None:
    """gpsd tells them apart from the position."""
    core = GpsdCore()
    messages = said(core, tpv(20), SKY, GST, tpv(21), tpv(32))
    _, with_sky, without = fixes(messages)
    assert (with_sky.satellites, with_sky.hdop, with_sky.pdop, with_sky.vdop) == (2, 1.1, 1.8, 1.5)
    assert with_sky.h_std_m == (25.0 / 2.0) ** 0.5
    assert with_sky.v_std_m == 6.5
    assert (without.satellites, without.hdop, without.h_std_m) == (None, None, None)


def test_the_sky_is_told_once_a_second_with_systems_and_signals() -> None:
    """Signal 0 is none, azimuth 360 is 0, and old gpsds tell no system."""
    core = GpsdCore()
    (sky,) = [each for each in said(core, SKY, tpv(20), SKY, SKY) if isinstance(each, GpsSky)]
    assert sky.t_ns == T_NS
    told = [(each.system, each.prn, each.azimuth_deg, each.snr_dbhz) for each in sky.satellites]
    assert told == [("gps", 17, 0.0, 32.0), ("glonass", 66, 75.0, 21.0), ("gps", 8, 8.0, None)]


def test_several_reports_of_an_instant_become_one_fix_as_soon_as_the_last_is_there() -> None:
    """Two an instant are learned from the first; the next is complete with its second report."""
    core = GpsdCore()
    partial = tpv(21, more='"mode":2,')
    assert len(said(core, tpv(20))) == 1
    assert said(core, tpv(20)) == []
    assert said(core, partial) == []
    (fix,) = fixes(said(core, tpv(21)))
    assert (fix.t_ns, fix.mode, fix.alt_m) == (T_NS + SECOND_NS, 3, 59.8)


def test_an_instant_with_fewer_reports_than_the_last_is_not_lost() -> None:
    """It is complete with the next one's first, or at the end."""
    core = GpsdCore()
    said(core, tpv(20), tpv(20), tpv(21))
    assert [fix.t_ns for fix in fixes(said(core, tpv(22)))] == [
        T_NS + SECOND_NS,
        T_NS + 2 * SECOND_NS,
    ]
    held = GpsdCore()
    said(held, tpv(20), tpv(20), tpv(21))
    assert len(held.handle(Flush(0), "gps-ingest")) == 1


def test_without_a_fix_the_receiver_is_heard_but_not_valid() -> None:
    """Mode 1 has a time; a report without one tells nothing."""
    core = GpsdCore()
    no_fix = '{"class":"TPV","device":"a","mode":1,"time":"2026-11-30T01:33:20.000Z"}'
    assert said(core, '{"class":"TPV","device":"a","mode":0}', no_fix) == [
        GpsFix(t_ns=T_NS, valid=False)
    ]


def test_status_tells_the_kind_of_fix() -> None:
    """RTK, dead reckoning and simulators are told from plain fixes."""
    kinds = [
        fixes(said(GpsdCore(), tpv(20, more=f'"mode":3,"status":{status},')))[0].fix
        for status in (1, 2, 3, 4, 5, 8, 99)
    ]
    assert kinds == ["gps", "dgps", "rtk_fixed", "rtk_float", "dead_reckoning", "simulator", "gps"]


def test_a_second_receiver_of_the_same_gpsd_is_left_out_until_the_first_is_gone() -> None:
    """Fixes of two antennas are not mixed; a receiver plugged in elsewhere is followed."""
    core = GpsdCore()
    assert len(fixes(said(core, tpv(20), tpv(20, "/dev/ttyS2"), tpv(21)))) == 2
    assert core.faults == {"device": 1}
    assert len(fixes(said(core, tpv(24, "/dev/ttyS2")))) == 1


def test_what_cannot_be_read_is_counted() -> None:
    """Half lines, other JSON, wrong types, a position off the globe."""
    core = GpsdCore()
    bad = ("{", "[]", "7", '{"class":"TPV","mode":"x"}', '{"class":"TPV","time":""}', "\ufffd")
    assert said(core, *bad) == []
    assert core.faults == {"report": len(bad)}
    off = tpv(20).replace("-37.784791667", "-97.0")
    assert [fix.valid for fix in fixes(said(core, off))] == [False]


def test_altitudes_of_gpsds_of_all_ages_are_above_the_sea() -> None:
    """Up to 3.18 `alt` is that and the only one; later it is undefined beside others."""
    told = {
        '"alt":449.5,': 449.5,
        '"alt":500.0,"altMSL":449.5,"altHAE":496.6,': 449.5,
        '"alt":500.0,"altHAE":473.2,': 449.5,  # less the geoid's 23.7
        "": None,
    }
    for more, alt_m in told.items():
        (fix,) = fixes(said(GpsdCore(), tpv(20, more=f'"mode":3,{more}')))
        assert fix.alt_m == (None if alt_m is None else pytest.approx(alt_m))


def test_times_of_the_first_gpsds_are_seconds() -> None:
    report = '{"class":"TPV","device":"a","mode":2,"time":1796002400.25,"lat":1.5,"lon":2}'
    (fix,) = fixes(said(GpsdCore(), report))
    assert fix.t_ns == T_NS + SECOND_NS // 4


def test_a_sky_in_several_reports_is_one() -> None:
    """Dilutions and counts in one, each constellation in another."""

    def part(more: str) -> str:
        return f'{{"class":"SKY","device":"/dev/ttyS1",{more}}}'

    def listed(gnssid: int, prns: range) -> str:
        views = (f'{{"PRN":{prn},"gnssid":{gnssid},"used":true}}' for prn in prns)
        return f'"satellites":[{",".join(views)}]'

    dilutions = part('"hdop":1.1,"pdop":1.8,"vdop":1.5,"nSat":7,"uSat":6')
    parts = [dilutions, part(f'"nSat":7,{listed(0, range(1, 5))}'), part(listed(6, range(65, 68)))]
    core = GpsdCore()
    messages = said(core, tpv(20), *parts, tpv(21), *parts, tpv(22))
    fix = fixes(messages)[-1]
    assert (fix.satellites, fix.hdop, fix.pdop, fix.vdop) == (6, 1.1, 1.8, 1.5)
    skies = [each for each in messages if isinstance(each, GpsSky)]
    assert [len(sky.satellites) for sky in skies] == [7] * len(skies)
    assert len(skies) == 2


def test_satellites_in_use_are_known_without_their_list() -> None:
    """Receivers without GSV: gpsd tells their number alone."""
    core = GpsdCore()
    report = '{"class":"SKY","device":"/dev/ttyS1","hdop":1.1,"nSat":9,"uSat":7}'
    assert fixes(said(core, tpv(20), report, tpv(21)))[-1].satellites == 7


def test_0_north_0_east_is_no_fix() -> None:
    zero = tpv(20).replace("-37.784791667", "0.0").replace("175.314896667", "0.0")
    assert [fix.valid for fix in fixes(said(GpsdCore(), zero))] == [False]


@pytest.mark.parametrize(
    "time", ['"2200-01-01T00:00:00.000Z"', '"2026-11-30T01:33:20"', "0.0", "1e300"]
)
def test_a_time_that_cannot_be_is_counted(time: str) -> None:
    core = GpsdCore()
    assert said(core, f'{{"class":"TPV","mode":3,"time":{time},"lat":1.5,"lon":2.5}}') == []
    assert core.faults == {"report": 1}
