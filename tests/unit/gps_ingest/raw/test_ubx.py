"""A u-blox receiver's bytes, sound and damaged, to gps_raw by what satellites broadcast."""

import gzip
import math
import random
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import pytest

from wayline.drive import Drive, DriveInfo, RawSource
from wayline.errors import InputError
from wayline.messages import GpsRaw, RawSatellite
from wayline.received import Recording, begun
from wayline.satellites.earth import SPEED_OF_LIGHT_MPS
from wayline.satellites.gps_time import WEEK_S, unix_ns
from wayline.satellites.place import ranged, rough_place_m
from wayline_bench.made_up_sky import (
    OWN_M,
    START_S,
    TOE_S,
    WEEK,
    epoch,
    navigation,
    recording,
    signal,
    sky,
)
from wayline_bench.made_up_ubx import Signal, orbit, rawx, sfrbx, ubx
from wayline_gps_ingest.recorded import recordings

LIGHT_MS_M = SPEED_OF_LIGHT_MPS * 1e-3


class Read(NamedTuple):
    """What came of a log."""

    messages: list[GpsRaw]
    recording: Recording

    @property
    def bad_input(self) -> int:
        return self.recording.bad_input()

    @property
    def without(self) -> dict[str, int]:
        return dict(self.recording.account().left_out)

    def placed(self) -> list[int]:
        """Of each epoch, how many satellites have a place."""
        return [sum(each.x_m is not None for each in told.satellites) for told in self.messages]


def read(folder: Path, data: bytes, navs: Sequence[str] = ()) -> Read:
    """A log through `[[raw]]`, as a drive's is."""
    path = folder / "raw.ubx"
    path.write_bytes(data)
    raw = RawSource(path=str(path), nav=tuple(navs))
    (each,) = recordings(Drive(drive=DriveInfo(vehicle_id="car"), raw=(raw,)), "drive.toml")
    messages = [message for _, message in each.messages if isinstance(message, GpsRaw)]
    return Read(messages, each)


def of(message: GpsRaw, prn: int) -> RawSatellite:
    return next(each for each in message.satellites if each.prn == prn)


def test_satellites_are_where_their_ephemerides_put_them(tmp_path: Path) -> None:
    """Against IS-GPS-200's own formulas, worked out apart; and the receiver is where they meet."""
    out = read(tmp_path, recording())
    satellites = sky()
    assert len(out.messages) == 21
    assert out.placed() == [0] + [len(satellites)] * 20
    assert len(satellites) >= 7
    assert out.bad_input == 0
    message, tow_s = out.messages[6], START_S + 5.0
    for seen in satellites:
        told = of(message, seen.orbit.prn)
        measured = signal(seen.orbit, tow_s)
        sent_s = tow_s - measured.pseudorange_m / SPEED_OF_LIGHT_MPS
        sent_s -= seen.orbit.clock_s(sent_s)
        assert (told.x_m, told.y_m, told.z_m) == pytest.approx(
            seen.orbit.place_m(sent_s), abs=0.002
        )
        assert told.clock_bias_m == pytest.approx(
            seen.orbit.lead_s(sent_s) * SPEED_OF_LIGHT_MPS, abs=0.001
        )
        assert told.doppler_hz == pytest.approx(measured.doppler_hz, abs=0.01)
        ahead, behind = (seen.orbit.place_m(sent_s + each) for each in (0.5, -0.5))
        motion = tuple(a - b for a, b in zip(ahead, behind, strict=True))
        assert (told.vx_mps, told.vy_mps, told.vz_mps) == pytest.approx(motion, abs=0.001)
        # the sky's up is the earth's centre's, the message's that of the ellipsoid
        assert told.elevation_deg == pytest.approx(seen.elevation_deg, abs=0.25)
    # the air is taken out of pseudoranges in which it never was: by up to 25 m, most at the horizon
    place_m = rough_place_m([each for each in map(ranged, message.satellites) if each])
    assert place_m is not None
    assert math.dist(place_m, OWN_M) < 40.0


def test_the_air_is_taken_out_more_near_the_horizon(tmp_path: Path) -> None:
    message = read(tmp_path, recording()).messages[-1]
    tow_s = START_S + 19.0
    delays_m = {
        seen.elevation_deg: signal(seen.orbit, tow_s).pseudorange_m
        - (of(message, seen.orbit.prn).pseudorange_m or 0.0)
        for seen in sky()
    }
    by_elevation = [delays_m[elevation] for elevation in sorted(delays_m)]
    assert by_elevation == sorted(by_elevation, reverse=True)
    assert 3.0 < by_elevation[-1] < by_elevation[0] < 40.0


def test_times_are_utc_and_numbers_the_receivers(tmp_path: Path) -> None:
    signals = [Signal(5, 2.2e7, -1234.5, pseudorange_std=4, doppler_std=15, cn0_dbhz=38)]
    (message,) = read(tmp_path, rawx(WEEK, START_S, signals)).messages
    assert message.t_ns == unix_ns(WEEK, START_S, 18)
    assert message.t_ns == (315_964_800 + WEEK * WEEK_S + int(START_S) - 18) * 10**9
    (told,) = message.satellites
    assert told == RawSatellite(
        system="gps",
        prn=5,
        pseudorange_m=2.2e7,
        pseudorange_std_m=0.16,
        doppler_hz=-1234.5,
        doppler_std_hz=None,
        cn0_dbhz=38.0,
        carrier_hz=1_575.42e6,
    )


def test_signals_are_named_by_their_systems(tmp_path: Path) -> None:
    signals = [
        Signal(5, 2.2e7, gnss=2, signal=0),
        Signal(7, 2.2e7, gnss=6, frequency=3),
        Signal(9, 2.2e7, gnss=3, signal=1),
        Signal(5, 2.2e7, gnss=0, signal=3),
        Signal(136, 3.8e7, gnss=1),
        Signal(2, 2.2e7, gnss=5),
    ]
    (message,) = read(tmp_path, rawx(WEEK, START_S, signals)).messages
    named = [(each.system, each.prn, each.carrier_hz) for each in message.satellites]
    assert named == [
        ("galileo", 5, 1_575.42e6),
        ("glonass", 7, 1_602.0e6 - 4 * 0.5625e6),
        ("beidou", 9, 1_561.098e6),
        ("sbas", 136, 1_575.42e6),
        ("qzss", 2, 1_575.42e6),
    ]


def test_half_cycles_and_phases_that_are_garbage_do_no_harm(tmp_path: Path) -> None:
    """The phase is not read: it may be anything while its half cycle is not known."""
    rubbish = [
        Signal(5, 2.2e7, 10.0, tracking=0b0001, phase_cycles=phase)
        for phase in (math.nan, -math.inf, 1e300)
    ]
    data = b"".join(rawx(WEEK, START_S + n, [each]) for n, each in enumerate(rubbish))
    out = read(tmp_path, data)
    assert [of(each, 5).pseudorange_m for each in out.messages] == [2.2e7] * 3
    assert out.bad_input == 0


def test_a_pseudorange_that_the_receiver_calls_invalid_is_unknown(tmp_path: Path) -> None:
    signals = [Signal(5, 2.2e7, 10.0, tracking=0b0110), Signal(6, math.nan, math.nan)]
    (message,) = read(tmp_path, rawx(WEEK, START_S, signals)).messages
    (told,) = message.satellites
    assert (told.prn, told.pseudorange_m, told.doppler_hz) == (5, None, 10.0)


def test_an_epoch_of_one_satellite_is_told_with_its_place(tmp_path: Path) -> None:
    seen = sky()[:1]
    out = read(tmp_path, epoch(seen, START_S) + navigation(seen) + epoch(seen, START_S + 1.0))
    assert out.placed() == [0, 1]
    assert out.messages[1].satellites[0].elevation_deg is None


def test_an_epoch_without_satellites_is_told(tmp_path: Path) -> None:
    assert read(tmp_path, rawx(WEEK, START_S, [])).messages[0].satellites == ()


def test_a_satellite_without_an_ephemeris_has_no_place(tmp_path: Path) -> None:
    satellites = sky()
    heard = navigation(satellites[1:])
    data = epoch(satellites, START_S) + heard + epoch(satellites, START_S + 1.0)
    out = read(tmp_path, data)
    told = of(out.messages[1], satellites[0].orbit.prn)
    assert (told.x_m, told.clock_bias_m) == (None, None)
    assert told.pseudorange_m is not None
    assert out.placed() == [0, len(satellites) - 1]
    assert out.without == {"without ephemeris": len(satellites) + 1}


def test_an_ephemeris_two_weeks_old_is_not_used(tmp_path: Path) -> None:
    old = sky(toe_s=TOE_S, week=WEEK - 2)
    now = sky()
    data = epoch(now, START_S) + navigation(old) + epoch(now, START_S + 1.0)
    out = read(tmp_path, data + navigation(now) + epoch(now, START_S + 2.0))
    assert out.placed() == [0, 0, len(now)]
    assert out.without["ephemeris too old"] > 0


def test_a_satellite_that_is_unhealthy_has_no_place(tmp_path: Path) -> None:
    seen = sky()[0]
    sick = seen._replace(orbit=orbit(seen.orbit.prn, WEEK, TOE_S, health=63))
    out = read(tmp_path, epoch([sick], START_S) + sfrbx(sick.orbit) + epoch([sick], START_S + 1))
    assert out.placed() == [0, 0]
    assert out.without["unhealthy"] == 1


def test_navigation_messages_from_before_the_first_epoch_count(tmp_path: Path) -> None:
    out = read(tmp_path, navigation(sky()) + epoch(sky(), START_S))
    assert out.placed() == [len(sky())]


def test_a_log_that_begins_without_navigation_messages_says_so(tmp_path: Path) -> None:
    out = read(tmp_path, epoch(sky(), START_S))
    (warning,) = out.recording.account().warnings
    assert "no satellite has a place (without ephemeris)" in warning
    assert "RXM-SFRBX" in warning


def test_who_plays_a_log_is_not_warned_before_its_satellites_can_have_been_heard(
    tmp_path: Path,
) -> None:
    """A player looks at the beginning first; navigation messages come within half a minute."""
    satellites = sky()
    epochs = [epoch(satellites, START_S + n) for n in range(30)]
    (tmp_path / "raw.ubx").write_bytes(b"".join(epochs[:15]) + navigation(satellites))
    raw = RawSource(path=str(tmp_path / "raw.ubx"))
    drive = Drive(drive=DriveInfo(vehicle_id="car"), raw=(raw,))
    assert begun(recordings(drive, "drive.toml")).warnings == []


def test_the_weeks_end_goes_over_into_the_next(tmp_path: Path) -> None:
    """A receiver may count its week up late, so that the week seems to begin again."""
    told = [(WEEK, 604_798.0), (WEEK, 604_799.0), (WEEK, 0.0), (WEEK + 1, 1.0), (WEEK + 1, 2.0)]
    data = b"".join(rawx(week, tow_s, [Signal(5, 2.2e7)]) for week, tow_s in told)
    out = read(tmp_path, data)
    steps_ns = [b.t_ns - a.t_ns for a, b in zip(out.messages, out.messages[1:], strict=False)]
    assert steps_ns == [10**9] * 4
    assert out.bad_input == 1


def test_a_second_of_the_week_beyond_its_end_is_the_next_weeks(tmp_path: Path) -> None:
    told = [(WEEK, 604_799.0), (WEEK, 604_800.0), (WEEK + 1, 1.0)]
    data = b"".join(rawx(week, tow_s, [Signal(5, 2.2e7)]) for week, tow_s in told)
    out = read(tmp_path, data)
    steps_ns = [b.t_ns - a.t_ns for a, b in zip(out.messages, out.messages[1:], strict=False)]
    assert steps_ns == [10**9] * 2


@pytest.mark.parametrize("lost_from", [0, 10])
def test_1024_weeks_that_a_receiver_lost_are_found(tmp_path: Path, lost_from: int) -> None:
    """From the start, as old receivers do, or from some day on."""
    data = b"".join(
        rawx(WEEK - 1024 * (n >= lost_from), START_S + n, [Signal(5, 2.2e7)]) for n in range(20)
    )
    out = read(tmp_path, data)
    assert [each.t_ns for each in out.messages] == [unix_ns(WEEK, START_S + n) for n in range(20)]
    assert out.bad_input == 20 - lost_from


@pytest.mark.parametrize(("state", "leap_ms"), [(1, 1), (1, -3), (3, 0)])
def test_a_clock_that_is_set_is_flagged(tmp_path: Path, state: int, leap_ms: int) -> None:
    """By what the pseudoranges show, or by what the receiver says."""
    satellites = sky()
    data = b"".join(
        epoch(
            satellites,
            START_S + n,
            clock_m=leap_ms * LIGHT_MS_M * (n >= 3),
            state=state if n == 3 else 1,
        )
        for n in range(6)
    )
    out = read(tmp_path, data)
    assert [each.clock_reset for each in out.messages] == [n == 3 for n in range(6)]
    assert out.bad_input == 1


def test_a_log_that_is_cut_is_read_up_to_there(tmp_path: Path) -> None:
    data = recording(seconds=5)
    for cut in (1, 2, 7, 100, 200):
        out = read(tmp_path, data[:-cut])
        assert len(out.messages) == 5
        assert out.bad_input == 1


def test_a_message_torn_in_the_middle_costs_itself(tmp_path: Path) -> None:
    satellites = sky()
    whole = [epoch(satellites, START_S + n) for n in range(6)]
    torn = b"".join(each[: len(each) // 2] if n == 2 else each for n, each in enumerate(whole))
    out = read(tmp_path, torn)
    seconds = [round((each.t_ns - unix_ns(WEEK, START_S)) * 1e-9) for each in out.messages]
    assert seconds == [0, 1, 3, 4, 5]
    assert out.bad_input >= 1


def test_other_things_that_a_receiver_sends_are_passed_over(tmp_path: Path) -> None:
    noise = b"$GNRMC,120000.00,A,4808.0,N,01131.0,E,0.0,0.0,070126,,,A*7C\r\n\xb5\xb5c\xb5"
    other = ubx(0x01, 0x07, bytes(92)) + ubx(0x02, 0x13, b"") + ubx(0x02, 0x13, bytes(8))
    data = b"".join(noise + other + epoch(sky(), START_S + n) for n in range(4))
    out = read(tmp_path, data)
    assert len(out.messages) == 4
    assert out.bad_input == 0


def test_a_message_that_does_not_hold_what_it_says_is_counted(tmp_path: Path) -> None:
    sound = rawx(WEEK, START_S, [Signal(5, 2.2e7)] * 3)
    short = ubx(0x02, 0x15, sound[6:-2][:60])
    empty = ubx(0x02, 0x15, b"")
    out = read(tmp_path, short + empty + sound)
    assert len(out.messages) == 1
    assert out.bad_input == 2


@pytest.mark.parametrize("tow_s", [math.nan, -1.0, 1e12])
def test_a_time_that_can_be_none_is_counted(tmp_path: Path, tow_s: float) -> None:
    out = read(tmp_path, rawx(WEEK, tow_s, [Signal(5, 2.2e7)]) + rawx(WEEK, 0, [Signal(5, 2.2e7)]))
    assert (len(out.messages), out.bad_input) == (1, 1)


@pytest.mark.parametrize("seed", range(8))
def test_flipped_bytes_cost_what_they_hit(tmp_path: Path, seed: int) -> None:
    """Whatever is damaged: no error, no epoch of another time."""
    chance = random.Random(seed)
    data = bytearray(recording(seconds=30))
    for _ in range(20):
        data[chance.randrange(len(data))] = chance.randrange(256)
    out = read(tmp_path, bytes(data))
    assert len(out.messages) >= 8
    first_ns = unix_ns(WEEK, START_S)
    assert all(-2e9 < each.t_ns - first_ns < 40e9 for each in out.messages)


def test_packed_logs_are_unpacked(tmp_path: Path) -> None:
    assert len(read(tmp_path, gzip.compress(recording(seconds=3))).messages) == 4
    packed = gzip.compress(recording(seconds=30))
    cut = read(tmp_path, packed[: len(packed) * 3 // 4])
    assert len(cut.messages) > 3
    assert cut.bad_input >= 1


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "holds no raw measurements that are known"),
        (b"$GPGGA,1,2*00\r\n" * 20, "holds no raw measurements that are known"),
        (ubx(0x01, 0x07, bytes(92)), "holds 1 UBX messages, none of them a whole RXM-RAWX"),
    ],
)
def test_a_log_of_which_nothing_is_read_says_why(tmp_path: Path, data: bytes, said: str) -> None:
    with pytest.raises(InputError, match=said):
        raise read(tmp_path, data).recording.nothing()


def test_a_file_that_is_another_format_than_said_is_refused(tmp_path: Path) -> None:
    (tmp_path / "raw").write_bytes(recording(seconds=1))
    raw = RawSource(path=str(tmp_path / "raw"), format="rinex")
    with pytest.raises(InputError, match="is no rinex, but ubx"):
        recordings(Drive(drive=DriveInfo(vehicle_id="car"), raw=(raw,)), "drive.toml")
