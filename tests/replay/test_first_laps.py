"""Ranges on lines that nobody has driven yet, from the first lap on."""

from functools import cache

import numpy as np

from unit.eta.route_drives import Metres, poses, route_of
from wayline.inputs import Tick
from wayline.messages import Arrivals, StopEvent
from wayline.route import Route
from wayline.tuning import Tuning
from wayline_eta.core import EtaCore
from wayline_eta.scores import Score, added, score_of, sums_of
from wayline_evaluation.eta import predictions_of

LINES, LAPS = 12, 4
BETWEEN_S = (3.0, 45.0)
"""Stands at lights."""


def line(random: np.random.Generator) -> tuple[list[Metres], Route, float]:
    """A loop with its plan, and the dwells that vehicles make there."""
    side_m, stops = random.uniform(300.0, 1_200.0), int(random.integers(4, 10))
    places = np.sort(random.choice(np.arange(0.05, 0.98, 0.06), stops, replace=False))
    dwell_s = random.uniform(5.0, 30.0)
    square: list[Metres] = [(0, 0), (side_m, 0), (side_m, side_m), (0, side_m), (0, 0)]
    route = route_of(
        square,
        stops_m=(places * 4.0 * side_m).tolist(),
        speed_mps=random.uniform(6.0, 12.0),
        dwell_s=dwell_s if random.random() < 0.6 else random.choice([0.0, 15.0]),
    )
    return square, route, dwell_s


def speeds_mps(route: Route, dwell_s: float, random: np.random.Generator) -> list[float]:
    """One a second: the plan is wrong as a whole and leg by leg, laps and chance vary, lights."""
    legs = np.exp(random.normal(0.1, 0.2) + random.normal(0.0, 0.12, len(route.stops)))
    lap_std, leg_std = random.uniform(0.02, 0.08), random.uniform(0.04, 0.14)
    has_lights, made, at_m = random.random() < 0.5, list[float](), 0.0
    for lap in range(LAPS):
        slower = legs * np.exp(random.normal(0.0, lap_std) + random.normal(0.0, leg_std, len(legs)))
        for place_m, factor in zip(route.stop_distances_m, slower, strict=True):
            ahead_m = lap * route.length_m + place_m - at_m
            seconds = max(round(ahead_m * factor / route.speed_at(0.0)), 1)
            driven = [ahead_m / seconds] * seconds
            if has_lights and random.random() < 0.5:
                at = int(random.integers(seconds // 5, seconds - seconds // 5 + 1))
                driven[at:at] = [0.0] * round(random.uniform(*BETWEEN_S))
            made += [*driven, *[0.0] * round(max(random.normal(dwell_s, 0.3 * dwell_s), 2.0))]
            at_m += ahead_m
    return made


@cache
def scored(first_lap: int, last_lap: int) -> Score:
    """What was told on all lines during some laps, against when the vehicle came."""
    sums = []
    for seed in range(1, LINES + 1):
        random = np.random.default_rng([seed, 77])
        square, route, dwell_s = line(random)
        core, told, events = EtaCore([route], Tuning()), list[Arrivals](), list[StopEvent]()
        drive = poses(square, speeds_mps(route, dwell_s, random), noise_m=1.0, seed=seed, laps=True)
        for pose, true_m in drive:
            core.handle(pose, "fusion")
            lap = true_m // route.length_m + 1
            for message in core.handle(Tick(pose.t_ns), "clock"):
                if isinstance(message, StopEvent):
                    events.append(message)
                elif isinstance(message, Arrivals) and first_lap <= lap <= last_lap:
                    told.append(message)
        sums.append(sums_of(predictions_of(told, events)))
    return score_of(added(sums))


def held(score: Score) -> list[float]:
    """Shares of the arrivals within their ranges: by minutes ahead, and of all.

    Few of the loops take more than a quarter of an hour.
    """
    spans = score.spans[:-1]
    counts = [span.count for span in spans]
    shares = [span.held_share or 0.0 for span in spans]
    return [*shares, float(np.average(shares, weights=counts))]


def test_ranges_hold_on_lines_that_nobody_has_driven() -> None:
    """Four laps each, by the plan at first."""
    *spans, pooled = held(scored(1, LAPS))
    assert all(0.70 <= each <= 0.90 for each in spans)
    assert 0.75 <= pooled <= 0.85


def test_ranges_hold_on_the_first_lap() -> None:
    """When a plan that is wrong by 20 % as a whole is all that is known."""
    *spans, pooled = held(scored(1, 1))
    assert all(0.70 <= each <= 0.90 for each in spans)
    assert 0.75 <= pooled <= 0.85
