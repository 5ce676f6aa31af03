"""Pure: what wheel sensors measure."""

from typing import Annotated, Literal, NamedTuple

import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from wayline.drive import Vehicle
from wayline.strict import Strict
from wayline_simulator.course import STEP_M
from wayline_simulator.journey import MOTION_STEP_S, Floats, Journey
from wayline_simulator.noise import gauss_markov, in_steps
from wayline_simulator.sampling import frame_times, instants

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]

MOST_DRIVEN_M = 5e8
"""What a counter may have at a drive's start; a truck is scrapped later, but not by much."""


class OdometerModel(Strict, frozen=True, kw_only=True):
    """`[odometer]`: wheel rate x nominal radius x (1 + scale) + noise, in whole steps."""

    rate_hz: Positive = 10.0
    """Judgement; brake controllers send at 10 to 100 Hz, gateways hand on fewer."""
    scale: float = 0.0
    """Share by which this very vehicle is known to read high."""
    scale_std: NotNegative = 0.02
    """The maker's choice and wear, from one vehicle to the next: 6 mm of tread are 2 % of a
    radius of 0.31 m."""
    scale_wander_std: NotNegative = 0.001
    """Of a first-order Gauss-Markov process on top: what speed and load leave of the radius; a
    judgement."""
    scale_wander_time_s: Positive = 1200.0
    """Judgement: the time in which a tyre warms up."""
    noise_mps: NotNegative = 0.02
    """Judgement: uneven teeth of the tone wheel and the road's roughness."""
    resolution_mps: Positive = 0.01
    """Judgement; SAE J1939-71 has 1/256 km/h, OBD-II (SAE J1979, PID 0Dh) 1 km/h."""
    truncated: bool = False
    """A reading is the whole steps below the speed, not the nearest, as css-164's OBD speed: GNSS
    is 0.988 times it plus 0.10 m/s, near the half step that cutting loses."""
    dead_zone_mps: NotNegative = 0.3
    """Slower reads 0: pulses come too seldom to be timed. Judgement."""
    latency_s: NotNegative = 0.02
    """A frame's speed is this old; judgement: the pulses of one cycle of the unit are averaged."""
    jitter_s: NotNegative = 0.001
    """Std of a frame's time around its instant; judgement."""
    counter_resolution_m: Positive | None = 0.05
    """Of a cumulative distance beside the speed, about one of 40 teeth; None: the bus has none."""
    counter_bits: Literal[16, 32] = 16
    """At 16 bits and 0.05 m the counter begins again every 3.3 km."""
    reverse_reported: bool = True
    """Beside the speed, which never is negative."""


class OdometerSamples(NamedTuple):
    """One frame each, shape (n,)."""

    times_s: Floats
    """When the frames came, from the drive's start; never decreases."""
    instants_s: Floats
    """When the wheels turned so."""
    speeds_mps: Floats
    """Never negative."""
    distances_m: Floats
    """The counter, in whole steps, wrapped; all 0 where the bus has none."""
    reverse: NDArray[np.bool_]


def measure(
    journey: Journey,
    model: OdometerModel,
    vehicle: Vehicle,
    *,
    device: np.random.Generator,
    random: np.random.Generator,
) -> OdometerSamples:
    """Wheel speed and distance over a drive, as if the wheels had the vehicle's nominal radius.

    From `device` comes what stays from one drive to the next.
    """
    scale = 1.0 + model.scale + model.scale_std * device.standard_normal()
    grid_s = instants(journey.duration_s, model.rate_hz, random)
    instants_s = grid_s - model.latency_s
    wander = gauss_markov(
        len(grid_s),
        1.0 / model.rate_hz,
        model.scale_wander_std,
        model.scale_wander_time_s,
        random,
    )
    rolled_mps = journey.motion.wheel_radps * vehicle.wheel_radius_m
    true_mps = np.interp(instants_s, journey.motion.times_s, rolled_mps)
    speeds_mps = true_mps * (scale + wander) + model.noise_mps * random.standard_normal(len(grid_s))
    return OdometerSamples(
        times_s=frame_times(grid_s, model.jitter_s, random),
        instants_s=instants_s,
        speeds_mps=_displayed(speeds_mps, true_mps, model),
        distances_m=_counted_m(journey, model, instants_s, rolled_mps * scale, random),
        reverse=_reverse(journey, instants_s),
    )


def _displayed(speeds_mps: Floats, true_mps: Floats, model: OdometerModel) -> Floats:
    """Speeds in whole steps; whether there are pulses to be timed depends on the true speed."""
    step_mps = model.resolution_mps
    turning_mps = np.where(true_mps > model.dead_zone_mps, np.maximum(speeds_mps, 0.0), 0.0)
    if model.truncated:
        return np.floor(turning_mps / step_mps) * step_mps
    return in_steps(turning_mps, step_mps)


def _counted_m(
    journey: Journey,
    model: OdometerModel,
    instants_s: Floats,
    read_mps: Floats,
    random: np.random.Generator,
) -> Floats:
    """The counter, forwards in reverse too; it began at some vehicle's first metre, not here."""
    if model.counter_resolution_m is None:
        return np.zeros(len(instants_s))
    steps_m = (read_mps[:-1] + read_mps[1:]) * (MOTION_STEP_S / 2.0)
    rolled_m = np.concatenate(([0.0], np.cumsum(steps_m)))
    gone_m = np.interp(instants_s, journey.motion.times_s, rolled_m)
    span_m = 2.0**model.counter_bits * model.counter_resolution_m
    start = random.uniform(0.0, min(span_m, MOST_DRIVEN_M)) / model.counter_resolution_m
    counts = np.floor(start + gone_m / model.counter_resolution_m) % 2.0**model.counter_bits
    distances_m: Floats = counts * model.counter_resolution_m
    return distances_m


def _reverse(journey: Journey, instants_s: Floats) -> NDArray[np.bool_]:
    backwards = journey.course.backwards
    places = (journey.at(instants_s).path_m / STEP_M).astype(np.intp)
    return backwards[np.clip(places, 0, len(backwards) - 2)]
