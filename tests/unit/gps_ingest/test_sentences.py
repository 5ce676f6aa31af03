"""Each kind of sentence brings its part of the fix, in our units."""

from typing import Any

import pytest

from unit.gps_ingest.receiver import LAT_DEG, LON_DEG, POSITION, fixes, flush, gga, hear, line, rmc
from wayline.messages import GpsFix, GpsSky
from wayline_gps_ingest.core import GpsIngestCore


def fix_of(*bodies: str) -> GpsFix:
    """The one fix of an epoch at 12:35:19, dated by an RMC in it."""
    core = GpsIngestCore()
    messages = hear(core, (line(body) for body in bodies))
    (fix,) = fixes(messages + flush(core))
    return fix


RMC = f"GPRMC,123519,A,{POSITION},022.4,084.4,230394,003.1,W"
GGA = f"GPGGA,123519,{POSITION},1,08,0.9,545.4,M,46.9,M,,"


def test_rmc_alone_is_a_fix_in_two_dimensions() -> None:
    fix = fix_of(RMC)
    assert (fix.valid, fix.mode, fix.fix) == (True, 2, "gps")
    assert fix.t_ns == 764_426_119_000_000_000  # 1994-03-23 12:35:19 UTC
    assert fix.lat_deg == pytest.approx(LAT_DEG, abs=1e-12)
    assert fix.lon_deg == pytest.approx(LON_DEG, abs=1e-12)
    assert fix.speed_mps == pytest.approx(22.4 * 0.514444, abs=1e-4)
    assert fix.course_deg == 84.4
    assert fix.alt_m is None


def test_gga_adds_altitude_satellites_and_dilution() -> None:
    fix = fix_of(RMC, GGA)
    assert (fix.mode, fix.alt_m, fix.geoid_sep_m) == (3, 545.4, 46.9)
    assert (fix.satellites, fix.hdop) == (8, 0.9)


@pytest.mark.parametrize(
    ("quality", "expected"),
    [(1, "gps"), (2, "dgps"), (4, "rtk_fixed"), (5, "rtk_float"), (6, "dead_reckoning")],
)
def test_quality_of_gga_is_the_kind_of_fix(quality: int, expected: str) -> None:
    assert fix_of(RMC, GGA.replace("E,1,", f"E,{quality},")).fix == expected


def test_dead_reckoning_is_said_wherever_any_sentence_says_it() -> None:
    assert fix_of(f"{RMC},E", GGA).fix == "dead_reckoning"


@pytest.mark.parametrize(
    ("modes", "expected"), [("AN", "gps"), ("NA", "gps"), ("DR", "rtk_fixed"), ("AF", "rtk_float")]
)
def test_gns_takes_the_best_constellation(modes: str, expected: str) -> None:
    fix = fix_of(f"GNGNS,123519,{POSITION},{modes},12,0.93,1482.5,-16.5,,", RMC)
    assert (fix.fix, fix.alt_m, fix.geoid_sep_m) == (expected, 1482.5, -16.5)


def test_gll_and_zda_are_enough() -> None:
    fix = fix_of("GPZDA,123519,23,03,1994,00,00", f"GPGLL,{POSITION},123519,A,D")
    assert (fix.valid, fix.fix, fix.t_ns) == (True, "dgps", 764_426_119_000_000_000)


@pytest.mark.parametrize(
    ("vtg", "speed_mps"),
    [
        ("GPVTG,054.7,T,034.4,M,010.0,N,018.5,K,A", 5.14444),
        ("GPVTG,054.7,T,,M,,N,036.0,K", 10.0),
        ("GPVTG,054.7,034.4,010.0,018.5", 5.14444),
    ],
)
def test_vtg_of_any_age_gives_speed_and_course(vtg: str, speed_mps: float) -> None:
    fix = fix_of(RMC, GGA, vtg)
    assert fix.speed_mps == pytest.approx(speed_mps, abs=1e-4)
    assert fix.course_deg == 54.7


def test_vtg_that_is_not_valid_tells_nothing() -> None:
    fix = fix_of(RMC, GGA, "GPVTG,000.0,T,,M,000.0,N,000.0,K,N")
    assert fix.speed_mps == pytest.approx(22.4 * 0.514444, abs=1e-4)
    assert fix.course_deg == 84.4


def test_a_differential_rmc_is_valid() -> None:
    assert fix_of(RMC.replace(",A,", ",D,")).valid


def test_gns_of_one_constellation_beside_the_whole_does_not_take_the_fix_away() -> None:
    """As NMEA 0183 has it: the GNGNS has the position, the others tell only their corrections."""
    whole = f"GNGNS,123519,{POSITION},DA,12,0.93,1482.5,-16.5,,"
    fix = fix_of(RMC, whole, "GPGNS,123519,,,,,,7,,,,5.2,23", "GLGNS,123519,,,,,,5,,,,5.2,23")
    assert (fix.valid, fix.fix, fix.satellites, fix.alt_m) == (True, "dgps", 12, 1482.5)


@pytest.mark.parametrize(
    ("rmz", "alt_m"), [("PGRMZ,48,f,3", 14.6304), ("PGRMZ,48,f,2", None), ("PGRMZ,,f,1", None)]
)
def test_garmins_altitude_in_feet_stands_in_where_it_is_of_the_fix(
    rmz: str, alt_m: float | None
) -> None:
    """Recorded in gpsd's garmin48 log; dimension 2 is an altitude that the user set."""
    fix = fix_of("GPZDA,123519,23,03,1994,00,00", f"GPGLL,{POSITION},123519,A", rmz)
    assert fix.alt_m == (alt_m and pytest.approx(alt_m))
    assert fix.mode == (3 if alt_m else 2)


def test_altitude_of_gga_stands_over_garmins_whole_feet() -> None:
    assert fix_of(RMC, GGA, "PGRMZ,48,f,3").alt_m == 545.4


def test_a_receiver_that_tells_no_speed_gets_one_from_its_positions_marked_as_derived() -> None:
    """Recorded in gpsd's mr-350p log, and the speed that gpsd has for it."""
    core = GpsIngestCore()
    bodies = [
        "GPZDA,051134.000,04,07,2012,,",
        "GPGGA,051134.000,4744.6980,N,12206.7275,W,1,05,1.9,135.4,M,-17.1,M,18.8,0000",
        "GPGGA,051135.000,4744.6981,N,12206.7273,W,1,05,1.9,134.7,M,-17.1,M,18.8,0000",
        "GPGGA,051155.000,4744.6981,N,12206.7273,W,1,05,1.9,134.7,M,-17.1,M,18.8,0000",
    ]
    first, second, late = fixes(hear(core, map(line, bodies)) + flush(core))
    assert (first.speed_mps, first.speed_derived) == (None, False)
    assert second.speed_mps == pytest.approx(0.311, abs=0.001)
    assert second.speed_derived
    assert (late.speed_mps, late.speed_derived) == (None, False)


def test_a_speed_that_the_receiver_tells_is_not_derived() -> None:
    core = GpsIngestCore()
    out = fixes(hear(core, [rmc("120000"), rmc("120001")]) + flush(core))
    assert [fix.speed_derived for fix in out] == [False, False]


def test_gst_is_one_sigma_an_axis() -> None:
    fix = fix_of(RMC, "GPGST,123519,5.0,,,,3.0,4.0,7.5")
    assert fix.h_std_m == pytest.approx(((9.0 + 16.0) / 2.0) ** 0.5)
    assert fix.v_std_m == 7.5


def test_a_deviation_of_zero_is_unknown() -> None:
    fix = fix_of(RMC, "GPGST,123519,0.0,,,,0.0,0.0,0.0")
    assert fix.h_std_m is None
    assert fix.v_std_m is None


def test_gsa_of_every_constellation_counts_towards_the_satellites_in_use() -> None:
    fix = fix_of(
        RMC,
        GGA,
        "GNGSA,A,3,01,02,03,04,05,06,07,08,09,10,11,12,1.5,0.8,1.2,1",
        "GNGSA,A,1,,,,,,,,,,,,,1.5,0.8,1.2,2",
        "GNGSA,A,3,01,02,,,,,,,,,,,1.5,0.8,1.2,3",
    )
    assert (fix.mode, fix.satellites) == (3, 14)
    assert (fix.pdop, fix.hdop, fix.vdop) == (1.5, 0.8, 1.2)


def test_a_constellation_without_used_satellites_does_not_take_the_fix_away() -> None:
    used = "GPGSA,A,2,01,02,03,,,,,,,,,,4.0,3.0,2.6"
    assert fix_of(RMC, GGA, used, "GLGSA,A,1,,,,,,,,,,,,,4.0,3.0,2.6").mode == 2


def test_mode_of_gsa_stands_over_an_altitude() -> None:
    assert fix_of(RMC, GGA, "GPGSA,A,2,01,02,03,,,,,,,,,,4.0,3.0,2.6").mode == 2


def test_what_receivers_write_for_unknown_is_unknown() -> None:
    fix = fix_of(
        f"GPRMC,123519,A,{POSITION},000.0,,230394,,",
        f"GPGGA,123519,{POSITION},1,03,0NaN,-5400.0,M,,M,,",
        "GPGSA,A,2,01,02,03,,,,,,,,,,0NaN,0NaN,0.0",
    )
    assert (fix.valid, fix.alt_m, fix.geoid_sep_m) == (True, None, None)
    assert (fix.hdop, fix.pdop, fix.vdop, fix.course_deg) == (None, None, None, None)


def test_the_papers_sentences_agree() -> None:
    """papers/004 tables A.1 and A.2; its GGA has 13 tokens where NMEA has 15."""
    core = GpsIngestCore()
    messages = hear(
        core,
        [
            "$GPGGA,163409.348,5916.4824,N,01707.3605,E,1,10,1.2,26.9,M,,0000*36",
            "$GPRMC,163409.348,A,5916.4824,N,01707.3605,E,46.97,308.49,061204,,*3E",
        ],
    )
    (fix,) = fixes(messages + flush(core))
    assert core.bad_input == 0
    assert fix.lat_deg == pytest.approx(59.2747067, abs=1e-7)
    assert fix.lon_deg == pytest.approx(17.1226750, abs=1e-7)
    assert (fix.alt_m, fix.geoid_sep_m) == (26.9, None)
    assert fix.speed_mps == pytest.approx(24.1635, abs=1e-4)
    assert fix.t_ns == 1_102_350_849_348_000_000


@pytest.mark.parametrize(
    "texts",
    [
        [rmc("123519", status="V"), gga("123519", quality=0)],
        [rmc("123519", status="V"), gga("123519")],
        [rmc("123519"), gga("123519", quality=0)],
    ],
)
def test_one_sentence_without_a_fix_makes_the_epoch_invalid(texts: list[str]) -> None:
    core = GpsIngestCore()
    (fix,) = fixes(hear(core, texts) + flush(core))
    assert (fix.valid, fix.mode, fix.fix) == (False, 1, "none")
    assert (fix.lat_deg, fix.lon_deg, fix.speed_mps) == (None, None, None)


def test_sky_names_systems_by_talker_and_number_and_says_which_are_used() -> None:
    core = GpsIngestCore()
    bodies = [
        RMC,
        "GPGSA,A,3,07,,,,,,,,,,,,1.5,0.8,1.2",
        "GPGSV,1,1,02,07,46,259,26,46,31,150,",
        "GLGSV,1,1,01,69,40,156,22",
        "GAGSV,1,1,01,07,-5,370,00,7",
        "PQGSV,1,1,01,02,20,100,30,1",
    ]
    messages = hear(core, (line(body) for body in bodies)) + flush(core)
    (sky,) = [message for message in messages if isinstance(message, GpsSky)]
    seen: list[tuple[Any, ...]] = [
        (each.system, each.prn, each.elevation_deg, each.azimuth_deg, each.snr_dbhz, each.used)
        for each in sky.satellites
    ]
    assert seen == [
        ("galileo", 7, -5.0, None, None, False),
        ("glonass", 69, 40.0, 156.0, 22.0, False),
        ("gps", 7, 46.0, 259.0, 26.0, True),
        ("qzss", 2, 20.0, 100.0, 30.0, False),
        ("sbas", 46, 31.0, 150.0, None, False),
    ]


def test_a_satellite_heard_on_two_signals_is_listed_once_with_the_stronger() -> None:
    core = GpsIngestCore()
    bodies = [RMC, "GPGSV,1,1,01,07,46,259,26,1", "GPGSV,1,1,01,07,46,259,31,6"]
    messages = hear(core, (line(body) for body in bodies)) + flush(core)
    (sky,) = [message for message in messages if isinstance(message, GpsSky)]
    assert [each.snr_dbhz for each in sky.satellites] == [31.0]
