"""RINEX observation and navigation files to gps_raw."""

import gzip
from pathlib import Path

import pytest

from unit.gps_ingest.raw.rinex_text import labelled, navigation_file, observations
from wayline.drive import Drive, DriveInfo, RawColumns, RawSource
from wayline.errors import InputError
from wayline.messages import GpsRaw
from wayline.received import Recording
from wayline.satellites.earth import SPEED_OF_LIGHT_MPS
from wayline.satellites.gps_time import unix_ns
from wayline_bench.made_up_sky import TOE_S, WEEK, epoch, navigation, recording, signal, sky
from wayline_bench.made_up_ubx import Signal
from wayline_gps_ingest.recorded import recordings


def opened(raw: RawSource) -> Recording:
    (each,) = recordings(Drive(drive=DriveInfo(vehicle_id="car"), raw=(raw,)), "drive.toml")
    return each


def messages(recording: Recording) -> list[GpsRaw]:
    return [message for _, message in recording.messages if isinstance(message, GpsRaw)]


@pytest.fixture
def files(tmp_path: Path) -> RawSource:
    """Twenty seconds from 02:05:00 GPS time, and the ephemerides of 02:00."""
    satellites = sky(TOE_S + 300.0)
    (tmp_path / "brdc.nav").write_text(navigation_file(each.orbit for each in satellites))
    epochs = [
        (
            5,
            float(second),
            [
                (f"G{each.orbit.prn:02d}", signal(each.orbit, TOE_S + 300.0 + second))
                for each in satellites
            ],
        )
        for second in range(20)
    ]
    (tmp_path / "raw.obs").write_text(observations(epochs))
    return RawSource(path=str(tmp_path / "raw.obs"), nav=(str(tmp_path / "brdc.nav"),))


def test_an_observation_and_a_navigation_file_make_placed_satellites(files: RawSource) -> None:
    recording = opened(files)
    told = messages(recording)
    satellites = sky(TOE_S + 300.0)
    assert [each.t_ns for each in told] == [
        unix_ns(WEEK, TOE_S + 300.0 + second) for second in range(20)
    ]
    assert recording.bad_input() == 0
    assert recording.account().left_out == {}
    for seen, each in zip(satellites, told[7].satellites, strict=True):
        measured = signal(seen.orbit, TOE_S + 307.0)
        sent_s = TOE_S + 307.0 - measured.pseudorange_m / SPEED_OF_LIGHT_MPS
        sent_s -= seen.orbit.clock_s(sent_s)
        place = seen.orbit.place_m(sent_s)
        assert (each.system, each.prn) == ("gps", seen.orbit.prn)
        # files have twelve digits of each number
        assert (each.x_m, each.y_m, each.z_m) == pytest.approx(place, abs=0.01)
        assert each.carrier_hz == 1_575.42e6
        assert 0.0 < measured.pseudorange_m - (each.pseudorange_m or 0.0) < 40.0


def test_several_navigation_files_are_one(files: RawSource, tmp_path: Path) -> None:
    satellites = sky(TOE_S + 300.0)
    parts = {"one.nav": satellites[:3], "other.nav": satellites[3:]}
    for name, part in parts.items():
        (tmp_path / name).write_text(navigation_file(each.orbit for each in part))
    raw = RawSource(path=files.path, nav=tuple(str(tmp_path / name) for name in parts))
    assert messages(opened(raw)) == messages(opened(files))


def test_glonass_has_the_channel_of_the_header(tmp_path: Path) -> None:
    fields = [("R05", Signal(5, 2.1e7, -100.0))]
    (tmp_path / "raw.obs").write_text(observations([(0, 0.0, fields)]))
    (told,) = messages(opened(RawSource(path=str(tmp_path / "raw.obs"))))
    (satellite,) = told.satellites
    assert (satellite.system, satellite.prn) == ("glonass", 5)
    assert satellite.carrier_hz == pytest.approx(1_602.5625e6)
    assert satellite.doppler_hz == pytest.approx(-100.0)


def test_a_u_blox_log_may_have_navigation_files_instead(files: RawSource, tmp_path: Path) -> None:
    satellites = sky(TOE_S + 300.0)
    (tmp_path / "raw.ubx").write_bytes(epoch(satellites, TOE_S + 300.0))
    (told,) = messages(opened(RawSource(path=str(tmp_path / "raw.ubx"), nav=files.nav)))
    assert sum(each.x_m is not None for each in told.satellites) == len(satellites)


def test_a_table_may_have_navigation_files_too(files: RawSource, tmp_path: Path) -> None:
    """Pseudoranges alone, the air and the satellites' clocks still in them."""
    satellites = sky(TOE_S + 300.0)
    time_s = unix_ns(WEEK, TOE_S + 300.0) // 10**9
    rows = "".join(
        f"{time_s},G{each.orbit.prn},{signal(each.orbit, TOE_S + 300.0).pseudorange_m:.3f}\n"
        for each in satellites
    )
    (tmp_path / "raw.csv").write_text("t,prn,range\n" + rows)
    columns = RawColumns(time="t", prn="prn", pseudorange_m="range")
    recording = opened(RawSource(path=str(tmp_path / "raw.csv"), columns=columns, nav=files.nav))
    (told,) = messages(recording)
    assert all(each.x_m is not None and each.clock_bias_m is not None for each in told.satellites)
    assert all(each.elevation_deg is not None for each in told.satellites)
    assert recording.account().warnings == ()


def test_ephemerides_of_another_day_are_warned_of(files: RawSource, tmp_path: Path) -> None:
    old = [each.orbit._replace(week=WEEK - 2) for each in sky(TOE_S + 300.0)]
    text = navigation_file(old).replace("2026 01 08", "2025 12 25")
    (tmp_path / "old.nav").write_text(text)
    recording = opened(RawSource(path=files.path, nav=(str(tmp_path / "old.nav"),)))
    assert all(each.x_m is None for told in messages(recording) for each in told.satellites)
    (warning,) = recording.account().warnings
    assert "ephemeris too old" in warning


@pytest.mark.parametrize("eccentricity", ["1.500000000000E+00", "             NaN "])
def test_an_ephemeris_that_puts_a_satellite_nowhere_is_counted(
    files: RawSource, eccentricity: str
) -> None:
    """A damaged digit is enough; the other satellites go on."""
    nav = Path(files.navs[0])
    of = sky(TOE_S + 300.0)[0].orbit.numbers["e"]
    nav.write_text(nav.read_text().replace(f"{of:19.12E}", f"{eccentricity:>19}"))
    recording = opened(files)
    told = messages(recording)
    assert [sum(each.x_m is None for each in epoch.satellites) for epoch in told] == [1] * 20
    assert set(recording.account().left_out) & {"ephemeris damaged", "without ephemeris"}


def test_a_file_that_is_cut_is_read_up_to_there(files: RawSource) -> None:
    text = Path(files.path).read_text()
    Path(files.path).write_text(text[: len(text) * 3 // 4])
    assert 10 < len(messages(opened(files))) < 20


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (labelled("1.0                 COMPACT RINEX FORMAT", "CRINEX VERS   / TYPE"), "Hatanaka"),
        (navigation_file([]), "but no observations"),
    ],
)
def test_other_files_of_the_family_are_refused_by_name(
    tmp_path: Path, text: str, said: str
) -> None:
    (tmp_path / "raw.obs").write_text(text)
    with pytest.raises(InputError, match=said):
        opened(RawSource(path=str(tmp_path / "raw.obs")))


def test_a_navigation_file_without_ephemerides_is_refused(files: RawSource, tmp_path: Path) -> None:
    (tmp_path / "empty.nav").write_text(navigation_file([]))
    with pytest.raises(InputError, match=r"empty\.nav: holds no ephemeris"):
        opened(RawSource(path=files.path, nav=(str(tmp_path / "empty.nav"),)))


def test_packed_files_are_unpacked(files: RawSource, tmp_path: Path) -> None:
    for name in ("raw.obs", "brdc.nav"):
        packed = gzip.compress((tmp_path / name).read_bytes())
        (tmp_path / f"{name}.gz").write_bytes(packed)
    plain = messages(opened(files))
    both = RawSource(path=f"{files.path}.gz", nav=(f"{files.navs[0]}.gz",))
    assert messages(opened(both)) == plain


def test_navigation_messages_and_files_agree(files: RawSource, tmp_path: Path) -> None:
    (tmp_path / "raw.ubx").write_bytes(recording(seconds=1) + navigation(sky()))
    heard = messages(opened(RawSource(path=str(tmp_path / "raw.ubx"))))[-1]
    told = messages(opened(RawSource(path=str(tmp_path / "raw.ubx"), nav=files.nav)))[-1]
    by_prn = {each.prn: each for each in told.satellites if each.x_m is not None}
    pairs = [(each, by_prn[each.prn]) for each in heard.satellites if each.prn in by_prn]
    assert len(pairs) >= 6
    for one, other in pairs:
        assert one.x_m == pytest.approx(other.x_m, abs=0.01)
        assert one.clock_bias_m == pytest.approx(other.clock_bias_m, abs=0.001)
