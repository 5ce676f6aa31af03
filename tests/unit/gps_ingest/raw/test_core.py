"""Raw measurements of every source become one kind: clocks, frames, motions, leaps."""

import math
from collections.abc import Sequence

import pytest

from builders import START_NS, at
from wayline.codec import decode, encode
from wayline.drive import Correction
from wayline.inputs import Flush
from wayline.messages import GpsRaw, RawSatellite
from wayline.satellites.earth import EARTH_MU_M3PS2, EARTH_RATE_RADPS, SPEED_OF_LIGHT_MPS
from wayline_gps_ingest.raw.core import RawIngestCore
from wayline_gps_ingest.raw.epoch import RawEpoch

RADIUS_M = 26_559_700.0
LIGHT_MS_M = SPEED_OF_LIGHT_MPS * 1e-3


def orbit(prn: int, seconds: float) -> tuple[list[float], list[float]]:
    """Place and motion, earth-fixed, of a satellite on a circle through the poles."""
    rate = math.sqrt(EARTH_MU_M3PS2 / RADIUS_M**3)
    angle, turn = 0.3 * prn + rate * seconds, -EARTH_RATE_RADPS * seconds
    flat, up = RADIUS_M * math.cos(angle), RADIUS_M * math.sin(angle)
    gone = -rate * up
    place = [flat * math.cos(turn), flat * math.sin(turn), up]
    motion = [
        gone * math.cos(turn) + EARTH_RATE_RADPS * place[1],
        gone * math.sin(turn) - EARTH_RATE_RADPS * place[0],
        rate * flat,
    ]
    return place, motion


def satellite(seconds: float = 0.0, prn: int = 1, **told: object) -> RawSatellite:
    x_m, y_m, z_m = orbit(prn, seconds)[0]
    known = {"pseudorange_m": 2.1e7, "x_m": x_m, "y_m": y_m, "z_m": z_m} | told
    return RawSatellite(system="gps", prn=prn, **known)  # type: ignore[arg-type]


def told(core: RawIngestCore, epochs: Sequence[RawEpoch]) -> list[GpsRaw]:
    messages = [message for epoch in epochs for message in core.handle(epoch, "test")]
    messages += core.handle(Flush(0), "test")
    return [message for message in messages if isinstance(message, GpsRaw)]


def epoch(seconds: float, *satellites: RawSatellite) -> RawEpoch:
    return RawEpoch(t_ns=at(seconds), satellites=satellites or (satellite(seconds),))


def test_an_epoch_of_one_satellite_is_told() -> None:
    (message,) = told(RawIngestCore(), [epoch(0.0)])
    assert message.satellites == (satellite(),)
    assert decode("gps_raw", encode(message)) == message


def test_an_epoch_of_none_is_told_too() -> None:
    (message,) = told(RawIngestCore(), [RawEpoch(t_ns=START_NS, satellites=())])
    assert message == GpsRaw(t_ns=START_NS)


@pytest.mark.parametrize("step_s", [0.1, 0.2, 1.0, 5.0])
def test_motions_are_differenced_from_places(step_s: float) -> None:
    messages = told(RawIngestCore(), [epoch(n * step_s) for n in range(12)])
    assert messages[0].satellites[0].vx_mps is None
    last = messages[-1].satellites[0]
    motion = orbit(1, 11 * step_s)[1]
    assert (last.vx_mps, last.vy_mps, last.vz_mps) == pytest.approx(tuple(motion), abs=0.02)


def test_a_motion_that_is_told_stands() -> None:
    given = satellite(vx_mps=1.0, vy_mps=2.0, vz_mps=3.0)
    (message,) = told(RawIngestCore(), [epoch(0.0, given)])
    assert message.satellites == (given,)


def test_a_place_by_new_ephemerides_makes_no_motion() -> None:
    """A new set moves a satellite by some metres at once."""
    epochs = [epoch(n, satellite(n, x_m=orbit(1, n)[0][0] + 8.0 * (n >= 5))) for n in range(10)]
    rates = [each.satellites[0].vx_mps for each in told(RawIngestCore(), epochs)]
    assert [rate is None for rate in rates] == [n in {0, 5} for n in range(10)]


def test_where_the_earths_turn_is_in_the_numbers_places_are_turned_back() -> None:
    """The reader turns them again by the same flight, and is where the table was."""
    given = satellite(pseudorange_m=2.4e7)
    (message,) = told(RawIngestCore(frozenset[Correction](["earth_rotation"])), [epoch(0.0, given)])
    back = message.satellites[0]
    assert back.x_m is not None
    assert back.y_m is not None
    angle = EARTH_RATE_RADPS * 2.4e7 / SPEED_OF_LIGHT_MPS
    again = (
        back.x_m * math.cos(angle) + back.y_m * math.sin(angle),
        back.y_m * math.cos(angle) - back.x_m * math.sin(angle),
    )
    assert again == pytest.approx((given.x_m, given.y_m), abs=1e-6)
    assert abs(back.x_m - (given.x_m or 0.0)) + abs(back.y_m - (given.y_m or 0.0)) > 50.0


def test_a_satellites_clock_is_added_once() -> None:
    given = satellite(clock_bias_m=-1234.5)
    (kept,) = told(RawIngestCore(), [epoch(0.0, given)])
    (behind,) = told(RawIngestCore(frozenset[Correction](["satellite_clock"])), [epoch(0.0, given)])
    assert kept.satellites[0].clock_bias_m == -1234.5
    assert behind.satellites[0].clock_bias_m is None


def leaping(leaps_m: Sequence[float], prns: Sequence[int] = (1, 2, 3)) -> list[RawEpoch]:
    """A second apart, pseudoranges growing by 400 m a second and leaping besides."""
    return [
        epoch(n, *(satellite(n, prn, pseudorange_m=2e7 + 400.0 * n + leap) for prn in prns))
        for n, leap in enumerate(leaps_m)
    ]


def test_a_clock_that_is_set_by_a_millisecond_is_flagged() -> None:
    core = RawIngestCore()
    messages = told(core, leaping([0.0, 0.0, LIGHT_MS_M, LIGHT_MS_M, -2 * LIGHT_MS_M]))
    assert [message.clock_reset for message in messages] == [False, False, True, False, True]
    assert core.faults == {"clock reset": 2}
    assert messages[2].satellites[0].pseudorange_m == 2e7 + 800.0 + LIGHT_MS_M


def test_one_satellite_that_leaps_is_no_clock() -> None:
    epochs = leaping([0.0, 0.0])
    odd = epoch(
        2.0,
        satellite(2.0, 1, pseudorange_m=2e7 + LIGHT_MS_M),
        *leaping([0.0] * 3)[2].satellites[1:],
    )
    assert not any(message.clock_reset for message in told(RawIngestCore(), [*epochs, odd]))


def test_a_leap_of_half_a_millisecond_is_none() -> None:
    assert not told(RawIngestCore(), leaping([0.0, 0.5 * LIGHT_MS_M]))[1].clock_reset


def test_a_time_far_ahead_is_not_believed() -> None:
    core = RawIngestCore(recorded=True)
    epochs = [epoch(n) for n in range(15)]
    week_ahead = epoch(604_800.0 + 15)
    messages = told(core, [*epochs, week_ahead, *(epoch(n) for n in range(16, 30))])
    assert [round((each.t_ns - START_NS) * 1e-9) for each in messages] == [
        *range(15),
        *range(16, 30),
    ]
    assert core.faults == {"clock": 1}


def test_an_epoch_that_comes_again_is_dropped() -> None:
    core = RawIngestCore()
    assert len(told(core, [epoch(0.0), epoch(1.0), epoch(1.0), epoch(2.0)])) == 3
    assert core.bad_input == 1
