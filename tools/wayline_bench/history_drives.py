"""Poses of a made-up drive, once a second: streets, turns and lights, as fusion tells them."""

import math
from collections.abc import Iterator

import numpy as np

from wayline.messages import Pose

START_NS = 1_790_000_000_000_000_000 // 86_400_000_000_000 * 86_400_000_000_000
"""The first instant of a day."""
SECOND_NS = 1_000_000_000
LAT_DEG, LON_DEG = 48.1, 11.5
NORTH_M, EAST_M = 111_200.0, 74_400.0
"""Metres in a degree there."""
STANDS_EVERY_S, STANDS_FOR_S = 90, 20
SPEED_MPS = 12.0


def drive(seconds: int, first_s: int = 0, seed: int = 1) -> Iterator[Pose]:
    """A pose a second: streets with turns, a light every minute and a half, noise as of fusion."""
    chance = np.random.default_rng(seed)
    east_m = north_m = distance_m = speed_mps = 0.0
    heading_deg = 90.0
    noise = chance.normal(size=(seconds, 4)).tolist()
    for second in range(seconds):
        stands = second % STANDS_EVERY_S < STANDS_FOR_S
        wanted_mps = 0.0 if stands else SPEED_MPS
        speed_mps += min(max(wanted_mps - speed_mps, -2.5), 1.5)
        if second % 45 == 0:
            heading_deg = (heading_deg + float(chance.choice([-90, 0, 0, 90]))) % 360.0
        east_m += speed_mps * math.sin(math.radians(heading_deg))
        north_m += speed_mps * math.cos(math.radians(heading_deg))
        distance_m += speed_mps
        yield Pose(
            t_ns=START_NS + (first_s + second) * SECOND_NS,
            mode="fused",
            lat_deg=LAT_DEG + (north_m + 0.05 * noise[second][0]) / NORTH_M,
            lon_deg=LON_DEG + (east_m + 0.05 * noise[second][1]) / EAST_M,
            alt_m=500.0 + 20.0 * math.sin(second / 200.0) + 0.1 * noise[second][2],
            heading_deg=(heading_deg + 0.2 * noise[second][3]) % 360.0,
            speed_mps=max(speed_mps + 0.05 * noise[second][0], 0.0),
            yaw_rate_degps=0.2 * noise[second][1],
            grade_pct=10.0 * math.cos(second / 200.0),
            distance_m=distance_m,
            east_std_m=1.8 + 0.1 * math.sin(second / 50.0),
            north_std_m=1.9 + 0.1 * math.cos(second / 50.0),
            east_north_cov_m2=0.2,
            heading_std_deg=0.6,
            speed_std_mps=0.06,
            alt_std_m=2.5,
            grade_std_pct=0.4,
        )
