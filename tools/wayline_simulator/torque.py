"""Pure: what an engine says of its torque, and the driveline of itself."""

from typing import Annotated, NamedTuple

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from wayline.drive import Vehicle
from wayline.errors import InputError
from wayline.strict import Strict
from wayline_simulator.journey import Floats, Journey
from wayline_simulator.noise import gauss_markov, in_steps
from wayline_simulator.sampling import frame_times, instants, motion_steps

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]

ENGINE_SPEED_STEP_RPM = 0.125
"""SAE J1939-71, SPN 190."""
GEAR_RATIO_STEP = 0.001
"""SAE J1939-71, SPN 526."""


class TorqueModel(Strict, frozen=True, kw_only=True):
    """`[torque]`: estimated from the fuel injected, in whole percents of the reference torque."""

    rate_hz: Positive = 10.0
    """The slope of papers/004 section 3.3 came so often; the torque itself may come faster."""
    gain_std: NotNegative = 0.02
    """From one engine to the next; judgement: injectors' tolerance and the fuel's heat value."""
    gain_wander_std: NotNegative = 0.01
    """Of a first-order Gauss-Markov process on top: temperatures of fuel, air and engine;
    judgement."""
    gain_wander_time_s: Positive = 300.0
    """Judgement."""
    offset_std_pct: NotNegative = 0.5
    """Accessories that the unit does not know, in percent of the reference torque; judgement."""
    offset_wander_std_pct: NotNegative = 0.3
    """Of a first-order Gauss-Markov process on top: the fan, compressor and generator take their
    share or not; judgement. A truck's fan alone takes some 20 kW at full speed."""
    offset_wander_time_s: Positive = 60.0
    """Judgement."""
    noise_pct: NotNegative = 0.5
    """Judgement: cycle to cycle and idle control."""
    resolution_pct: Positive = 1.0
    """SAE J1939-71, SPN 513, and SAE J1979, PID 62h."""
    latency_s: NotNegative = 0.05
    """A frame's torque is this old: a few working cycles; judgement."""
    jitter_s: NotNegative = 0.002
    """Std of a frame's time around its instant; judgement."""
    mass_error_std: NotNegative = 0.03
    """Share by which the mass in drive.toml is off; judgement for a vehicle that was weighed."""
    driveline_reported: bool = True
    """Gear, its ratio, clutch and brake are on the bus; OBD-II has none of them."""
    overrun_reported: bool = True
    """Negative torque is on the bus; css-164 says 0 on the overrun."""
    slope_reported: bool = False
    """The vehicle reports a slope of its own (papers/004), +13 % while braking."""
    slope_speed_noise_mps: NotNegative = 0.005
    """White noise of the wheel speed that this slope's acceleration is made of; judgement."""
    slope_filter_s: Positive = 0.5
    """Time constant of the slope's low-pass; judgement: papers/004 does not say."""
    slope_resolution_pct: Positive = 0.1
    """Judgement: papers/004 does not say."""


class TorqueSamples(NamedTuple):
    """One frame each, shape (n,)."""

    times_s: Floats
    """When the frames came, from the drive's start; never decreases."""
    instants_s: Floats
    """When the engine was so."""
    torques_pct: Floats
    """Net, of the reference torque; negative on the overrun."""
    engine_speeds_rpm: Floats
    gears: NDArray[np.int8]
    """0 neutral, -1 reverse."""
    gear_ratios: Floats
    """0 in neutral."""
    brake: NDArray[np.bool_]
    clutch: NDArray[np.bool_]
    """True: the driveline is open."""


def assumed_vehicle(vehicle: Vehicle, model: TorqueModel, device: np.random.Generator) -> Vehicle:
    """The vehicle as it is believed to be, in drive.toml and in its own slope."""
    share = 1.0 + model.mass_error_std * device.standard_normal()
    return msgspec.structs.replace(vehicle, mass_kg=vehicle.mass_kg * max(share, 0.1))


def reference_torque_nm(vehicle: Vehicle) -> float:
    """What 100 % means. Raises InputError where the vehicle does not say."""
    if vehicle.engine_reference_torque_nm is None:
        raise InputError(
            "vehicle",
            "engine_reference_torque_nm is missing, and its bus gives torque in percent",
            "add it",
        )
    return vehicle.engine_reference_torque_nm


def measure(
    journey: Journey,
    model: TorqueModel,
    vehicle: Vehicle,
    *,
    device: np.random.Generator,
    random: np.random.Generator,
) -> TorqueSamples:
    """Engine and driveline over a drive. From `device` comes what stays from drive to drive."""
    gain = 1.0 + model.gain_std * device.standard_normal()
    offset_pct = model.offset_std_pct * device.standard_normal()
    grid_s = instants(journey.duration_s, model.rate_hz, random)
    count = len(grid_s)
    instants_s = grid_s - model.latency_s
    motion = journey.motion
    step = motion_steps(motion, instants_s)
    step_s = 1.0 / model.rate_hz
    wander = gauss_markov(count, step_s, model.gain_wander_std, model.gain_wander_time_s, random)
    true_pct = 100.0 * motion.engine_torque_nm[step] / reference_torque_nm(vehicle)
    errors_pct = offset_pct + model.noise_pct * random.standard_normal(count)
    errors_pct += gauss_markov(
        count, step_s, model.offset_wander_std_pct, model.offset_wander_time_s, random
    )
    read_pct = true_pct * (gain + wander) + errors_pct
    if not model.overrun_reported:
        read_pct = np.maximum(read_pct, 0.0)
    speeds_rpm = np.interp(instants_s, motion.times_s, motion.engine_speed_rpm)
    return TorqueSamples(
        times_s=frame_times(grid_s, model.jitter_s, random),
        instants_s=instants_s,
        torques_pct=in_steps(read_pct, model.resolution_pct),
        engine_speeds_rpm=in_steps(speeds_rpm, ENGINE_SPEED_STEP_RPM),
        gears=motion.gear[step],
        gear_ratios=in_steps(np.nan_to_num(motion.gear_ratio[step]), GEAR_RATIO_STEP),
        brake=motion.brake[step],
        clutch=motion.clutch[step],
    )
