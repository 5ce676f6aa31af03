"""A receiver that claims metres and is off by tens, beside good wheels and a good gyro."""

import cmath
import math
from collections.abc import Iterable, Iterator

import msgspec
import numpy as np
import pytest

from builders import about, only, run_core
from unit.fusion.drives import (
    ORIGIN,
    Sensors,
    error_m,
    heading_error_deg,
    messages_of,
    seconds_of,
    truth_of,
    winding,
)
from wayline.messages import GpsFix, Message, Pose
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.evidence.track_fit import Seen, Track

SECOND_NS = 1_000_000_000
BIAS_STD_RADPS = math.radians(1.0)


def walk(turned_rad: float, noise_m: float, bias_radps: float = 0.0) -> Track:
    """Sixty seconds of a bent way, as reckoned and, turned counter-clockwise, as the fixes are."""
    rng = np.random.default_rng(3)
    track = Track()
    fix_m = reckoned_m = 0j
    for second in range(60):
        step = 10.0 * cmath.exp(1j * math.sin(second / 8.0))
        fix_m += step * cmath.exp(1j * turned_rad)
        # a bias turns the reckoned way clockwise
        reckoned_m += step * cmath.exp(-1j * bias_radps * (second - 59.5))
        off_m = complex(*rng.normal(0.0, noise_m, 2))
        track = track.with_fix(Seen(second * SECOND_NS, fix_m + off_m, reckoned_m, float(second)))
    return track


def test_a_fit_tells_the_turn_the_place_and_the_noise() -> None:
    track = walk(0.7, 8.0)
    fit = track.fit(track.seen[-1], 2.0, 0.0, 1e-6)
    assert fit is not None
    assert fit.turn_rad == about(-0.7, 0.05)
    assert abs(fit.turn_rad + 0.7) < 3.0 * fit.turn_std_rad
    assert 7.0 < fit.noise_m < 18.0, "more than what is left: so few are wrong each in its own way"
    assert abs(fit.place_m - walk(0.7, 0.0).seen[-1].fix_m) < 8.0


def test_a_fit_takes_a_known_bias_off_and_finds_an_unknown_one() -> None:
    bias_radps = math.radians(0.4)
    track = walk(0.7, 1.0, bias_radps)
    for known_radps in (bias_radps, 0.0):
        fit = track.fit(track.seen[-1], 1.0, known_radps, BIAS_STD_RADPS)
        assert fit is not None
        assert fit.bias_radps == about(bias_radps, math.radians(0.1))
        assert fit.turn_rad == about(-0.7, 0.06)


def test_few_fixes_or_a_stand_tell_nothing() -> None:
    track = Track()
    for second in range(60):
        track = track.with_fix(Seen(second * SECOND_NS, 5.0 + 1j, 0j, 0.0))
    assert len(track.seen) == 1
    assert track.fit(track.seen[-1], 2.0, 0.0, BIAS_STD_RADPS) is None


def lying(messages: Iterable[Message], std_m: float, time_s: float, seed: int) -> Iterator[Message]:
    """Fixes without speed and course, off by an error that lasts, which they do not claim."""
    rng = np.random.default_rng(seed)
    off_m = rng.normal(0.0, std_m, 2)
    kept = math.exp(-1.0 / time_s)
    for message in messages:
        if not isinstance(message, GpsFix):
            yield message
            continue
        off_m = kept * off_m + math.sqrt(1.0 - kept**2) * rng.normal(0.0, std_m, 2)
        east_m, north_m = ORIGIN.to_plane(message.lat_deg or 0.0, message.lon_deg or 0.0)
        lat_deg, lon_deg = ORIGIN.to_geodetic(east_m + off_m[0], north_m + off_m[1])
        yield msgspec.structs.replace(
            message, lat_deg=lat_deg, lon_deg=lon_deg, speed_mps=None, course_deg=None, h_std_m=2.0
        )


@pytest.mark.parametrize("every_s", [1, 5, 10])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_receiver_that_lies_from_the_start_leads_nobody_astray(seed: int, every_s: int) -> None:
    truths = truth_of(winding, 300.0)
    told = [
        message
        for message in messages_of(winding, truths, Sensors(gyro_bias_degps=0.2))
        if not isinstance(message, GpsFix) or round(seconds_of(message.t_ns)) % every_s == 0
    ]
    fixes = list(lying(told, 20.0, 20.0 / every_s, seed))
    poses = only(run_core(FusionCore(Tuning()), fixes), Pose)
    later = [pose for pose in poses if seconds_of(pose.t_ns) > 100.0]
    errors_m = sorted(error_m(pose, truths) for pose in later)
    assert errors_m[len(errors_m) * 95 // 100] < 50.0, "of the fixes themselves 49 m"
    turned_deg = sorted(heading_error_deg(pose, truths) for pose in later)
    assert turned_deg[len(turned_deg) * 95 // 100] < 20.0
    honest = [
        error_m(pose, truths) < 2.0 * math.hypot(pose.east_std_m or 0.0, pose.north_std_m or 0.0)
        for pose in later
    ]
    assert sum(honest) / len(honest) > 0.85
