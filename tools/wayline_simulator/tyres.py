"""Pure: how fast driven wheels turn: rolling radius, slip, and wheels that spin or lock."""

from typing import Annotated

import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from wayline.strict import Strict
from wayline_simulator.journey import MOTION_STEP_S, Floats

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]

REFERENCE_MPS = 60.0 / 3.6
"""DIN 70020-5 gives a tyre's dynamic rolling circumference at 60 km/h."""
REFERENCE_KELVIN = 293.15
"""Tyres are inflated at room temperature."""
KELVIN = 273.15
EVENT_S = (0.3, 1.0)
"""How long wheels spin or lock before driver or control unit ends it; judgement."""
SPIN_MPS = (0.5, 2.0)
"""By how much spinning wheels are faster at most; judgement."""
SPIN_AFTER_S = 0.3
"""After the vehicle began to roll."""
LOCK_BELOW_MPS, LOCK_ABOVE_MPS = 12.0, 2.0
"""Speed at which wheels lock: on ice before a stop, but not at the very stop; judgement."""


class TyreModel(Strict, frozen=True, kw_only=True):
    """Effective rolling radius = nominal x (1 + sum of small shares), and slip.

    The form follows Pacejka, Tire and Vehicle Dynamics, on the effective rolling radius (growth
    with the square of speed, flattening with load), made linear around the nominal state.
    """

    speed_share: NotNegative = 0.0005
    """Growth at REFERENCE_MPS, with the square of speed: 0.2 % at 120 km/h; judgement, belts of
    radial tyres hardly stretch."""
    nominal_mass_kg: Positive
    """Of the vehicle whose wheels have the nominal radius."""
    load_share: NotNegative = 0.010
    """Shrinks by so much when the load doubles; judgement."""
    pressure_share: NotNegative = 0.012
    """Shrinks by so much without any pressure, by extrapolation: a quarter less makes 0.3 %, the
    order that indirect tyre-pressure monitors must see. Judgement."""
    pressure_std: NotNegative = 0.04
    """Share by which drivers' inflation is off; judgement."""
    warming_kelvin: NotNegative = 22.0
    """A tyre on a trip ends so much above the air; judgement."""
    warming_s: Positive = 900.0
    """Time constant of that; judgement."""
    slip_stiffness: Positive = 25.0
    """Longitudinal force per slip and wheel load in the linear range: 20 to 30 on dry asphalt in
    the usual magic-formula sets (Pacejka); judgement within."""


def rolling_radius_m(
    tyres: TyreModel,
    *,
    nominal_m: float,
    mass_kg: float | Floats,
    inflation: float,
    temperature_c: float,
    times_s: Floats,
    speeds_mps: Floats,
) -> Floats:
    """Effective rolling radius at rest or rolling, shape (n,).

    `inflation` is the filled share of the nominal pressure at 20 degrees; air in a closed tyre
    follows Gay-Lussac's law.
    """
    warm_kelvin = tyres.warming_kelvin * (1.0 - np.exp(-times_s / tyres.warming_s))
    pressure = inflation * (KELVIN + temperature_c + warm_kelvin) / REFERENCE_KELVIN
    growth = tyres.speed_share * (speeds_mps / REFERENCE_MPS) ** 2
    flattening = tyres.load_share * (mass_kg / tyres.nominal_mass_kg - 1.0)
    return nominal_m * (1.0 + growth - flattening + tyres.pressure_share * (pressure - 1.0))


def slip(tyres: TyreModel, force_n: Floats, wheel_load_n: float | Floats) -> Floats:
    """Share by which wheels turn faster than they roll when they push with a force."""
    return np.clip(force_n / (tyres.slip_stiffness * wheel_load_n), -0.1, 0.1)


def spinning_mps(speeds_mps: Floats, probability: float, random: np.random.Generator) -> Floats:
    """What spinning adds to the wheels' speed: a bump after some of the launches."""
    rolling = speeds_mps > 0.0
    launches = np.flatnonzero(rolling[1:] & ~rolling[:-1]) + round(SPIN_AFTER_S / MOTION_STEP_S)
    added_mps = np.zeros_like(speeds_mps)
    for launch in launches[random.random(len(launches)) < probability]:
        count = _event_steps(random)
        bump = np.sin(np.linspace(0.0, np.pi, count + 2)[1:-1]) * random.uniform(*SPIN_MPS)
        room = added_mps[launch : launch + count]
        room += bump[: len(room)]
    return np.where(rolling, added_mps, 0.0)


def locked(
    speeds_mps: Floats,
    brake: NDArray[np.bool_],
    probability: float,
    random: np.random.Generator,
) -> NDArray[np.bool_]:
    """Where the driven wheels stand though the vehicle moves: once in some of the brakings."""
    suited = brake & (speeds_mps < LOCK_BELOW_MPS) & (speeds_mps > LOCK_ABOVE_MPS)
    starts = np.flatnonzero(suited[1:] & ~suited[:-1]) + 1
    standing = np.zeros(len(speeds_mps), dtype=np.bool_)
    for start in starts[random.random(len(starts)) < probability]:
        standing[start : start + _event_steps(random)] = True
    return standing & brake


def _event_steps(random: np.random.Generator) -> int:
    return round(random.uniform(*EVENT_S) / MOTION_STEP_S)
