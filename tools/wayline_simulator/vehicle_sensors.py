"""Pure: everything that the sensors on a vehicle's bus measure of a journey."""

from typing import NamedTuple

import numpy as np

from wayline.drive import Vehicle
from wayline_simulator import barometer, gyro, odometer, torque
from wayline_simulator.barometer import BarometerSamples
from wayline_simulator.gyro import GyroSamples
from wayline_simulator.journey import Floats, Journey
from wayline_simulator.odometer import OdometerSamples
from wayline_simulator.presets import Preset
from wayline_simulator.reported_slope import reported_slopes_pct
from wayline_simulator.torque import TorqueSamples
from wayline_simulator.weather import Weather


class VehicleSamples(NamedTuple):
    """None: the vehicle has no such sensor."""

    gyro: GyroSamples | None
    odometer: OdometerSamples | None
    torque: TorqueSamples | None
    slopes_pct: Floats | None
    """The vehicle's own, one beside every torque."""
    barometer: BarometerSamples | None


def measure_vehicle(
    journey: Journey,
    preset: Preset,
    weather: Weather,
    *,
    vehicle: Vehicle,
    assumed: Vehicle,
    device: np.random.Generator,
    random: np.random.Generator,
) -> VehicleSamples:
    """The samples of the preset's sensors; `assumed` is what the vehicle believes of itself.

    `device` is seeded alike for all drives of a vehicle, `random` for each drive anew. Every
    sensor draws from streams of its own, so that one more does not change the others.
    """
    devices, randoms = device.spawn(4), random.spawn(5)

    def stream(index: int) -> dict[str, np.random.Generator]:
        return {"device": devices[index], "random": randoms[index]}

    engine, slopes_pct = None, None
    if preset.torque:
        engine = torque.measure(journey, preset.torque, vehicle, **stream(2))
        if preset.torque.slope_reported:
            slopes_pct = reported_slopes_pct(journey, preset.torque, engine, assumed, randoms[4])
    return VehicleSamples(
        gyro=gyro.measure(journey, preset.gyro, weather, **stream(0)) if preset.gyro else None,
        odometer=odometer.measure(journey, preset.odometer, vehicle, **stream(1))
        if preset.odometer
        else None,
        torque=engine,
        slopes_pct=slopes_pct,
        barometer=barometer.measure(journey, preset.barometer, weather, **stream(3))
        if preset.barometer
        else None,
    )
