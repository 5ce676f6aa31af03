"""Pure: engine and gearbox of a vehicle, and when a driver or an automated gearbox shifts."""

import math
from typing import Annotated

import numpy as np
from msgspec import Meta

from wayline.strict import Strict

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]

RPM_PER_RADPS = 30.0 / math.pi
TABLE_STEP_RPM = 10.0
"""Between the entries of the torque tables; a curve has no corner that is finer."""
FUEL_CUT_FADE_RPM = 300.0
"""So far above idle speed the overrun's fuel cut is complete; judgement."""
OPEN_SHARE = 0.9
"""Of the launch speed: the clutch opens before slower wheels stall the engine; judgement."""


class EngineModel(Strict, frozen=True, kw_only=True):
    """A combustion engine; torque is net at the crankshaft."""

    speeds_rpm: tuple[Positive, ...]
    """Of the points of the full-load curve, in ascending order."""
    torques_nm: tuple[Positive, ...]
    idle_rpm: Positive
    launch_rpm: Positive
    """Held while the clutch slips; with wheels this fast it closes."""
    drag_nm: NotNegative
    """Torque of friction and pumping without fuel, at rest."""
    drag_nm_per_rpm: NotNegative
    """How friction and pumping grow with the engine's speed."""
    exhaust_brake_nm: NotNegative = 0.0
    """What a valve in the exhaust adds to the drag at most; used before the wheel brakes."""
    inertia_kgm2: NotNegative
    """Crankshaft, flywheel and clutch."""


class GearboxModel(Strict, frozen=True, kw_only=True):
    """Gears and when they are changed."""

    ratios: tuple[Positive, ...]
    """From the first gear up."""
    reverse_ratio: Positive
    final_drive_ratio: Positive
    efficiency: Annotated[float, Meta(gt=0.0, le=1.0)]
    """From crankshaft to wheels; divides on the overrun, so that it always costs."""
    launch_gear: Annotated[int, Meta(ge=1)]
    """The lowest gear that is used; lower ones are crawlers."""
    shift_s: NotNegative
    """With the clutch open."""
    ramp_s: NotNegative
    """In which torque is taken away before the clutch opens."""
    up_light_rpm: Positive
    """Engine speed for the next gear with little torque."""
    up_full_rpm: Positive
    """Engine speed for the next gear at full load."""
    down_light_rpm: Positive
    """Engine speed for the next lower gear with little torque."""
    down_full_rpm: Positive
    """Engine speed for the next lower gear at full load."""
    skip: Annotated[int, Meta(ge=0)]
    """Gears that may be left out when shifting up."""
    pause_s: NotNegative
    """Between two shifts at least."""


class TorqueTables:
    """Greatest and least net torque for every TABLE_STEP_RPM from 0."""

    def __init__(self, engine: EngineModel) -> None:
        """Beyond the curve's last speed the limiter takes all torque away within 200 rpm."""
        last_rpm = engine.speeds_rpm[-1]
        speeds_rpm = np.arange(0.0, 2.0 * last_rpm, TABLE_STEP_RPM)
        full_nm = np.interp(
            speeds_rpm,
            (*engine.speeds_rpm, last_rpm + 200.0),
            (*engine.torques_nm, 0.0),
        )
        fade = np.clip((speeds_rpm - engine.idle_rpm) / FUEL_CUT_FADE_RPM, 0.0, 1.0)
        drag_nm = engine.drag_nm + engine.exhaust_brake_nm + engine.drag_nm_per_rpm * speeds_rpm
        self._full_nm: list[float] = full_nm.tolist()
        self._drag_nm: list[float] = (fade * drag_nm).tolist()
        self._last = len(self._full_nm) - 1

    def full_nm(self, speed_rpm: float) -> float:
        """At full throttle."""
        return self._full_nm[min(int(speed_rpm / TABLE_STEP_RPM), self._last)]

    def drag_nm(self, speed_rpm: float) -> float:
        """At most on the overrun, as a positive number; 0 at idle speed."""
        return self._drag_nm[min(int(speed_rpm / TABLE_STEP_RPM), self._last)]


def shift_up_rpm(gearbox: GearboxModel, load: float) -> float:
    """Engine speed from which a higher gear is wanted; `load` is the share of full torque."""
    return gearbox.up_light_rpm + (gearbox.up_full_rpm - gearbox.up_light_rpm) * load


def shift_down_rpm(gearbox: GearboxModel, load: float) -> float:
    """Engine speed below which a lower gear is wanted."""
    return gearbox.down_light_rpm + (gearbox.down_full_rpm - gearbox.down_light_rpm) * load
