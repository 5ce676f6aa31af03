"""Pure: what is simulated: road, driver, vehicle, sensors and what befalls them."""

import datetime as dt
from typing import Annotated, Any, Literal, TypeVar

import msgspec
from msgspec import Meta

from wayline.drive import VehicleId
from wayline.errors import InputError
from wayline.strict import Strict, fitted
from wayline_simulator.damage import Damage
from wayline_simulator.driver import DriverModel
from wayline_simulator.gps_events import GpsEvents
from wayline_simulator.loads import LoadChange
from wayline_simulator.presets import PRESETS, Preset
from wayline_simulator.raw_model import RawModel
from wayline_simulator.road_model import RoadModel
from wayline_simulator.vehicle import VEHICLES, VehicleModel
from wayline_simulator.weather import Weather

SensorName = Literal["gps", "gyro", "odometer", "torque", "barometer"]
SENSORS: tuple[SensorName, ...] = ("gps", "gyro", "odometer", "torque", "barometer")
Overlay = dict[str, Any]
ModelType = TypeVar("ModelType", bound=Strict)


class Scenario(Strict, frozen=True, kw_only=True):
    """A scenario file. The tables of the sensors hold only what differs from the preset."""

    description: str = ""
    vehicle_id: VehicleId = "simulated"
    vehicle: str = "car"
    """A name in `wayline_simulator.vehicle.VEHICLES`."""
    mass_kg: Annotated[float, Meta(gt=0.0)] | None = None
    """Loaded otherwise than that vehicle."""
    loads: tuple[LoadChange, ...] = ()
    """Changes of the load on the way."""
    preset: str = "consumer"
    """A name in `wayline_simulator.presets.PRESETS`."""
    sensors: tuple[SensorName, ...] = SENSORS
    """Of the preset's, those that the vehicle has."""
    seed: Annotated[int, Meta(ge=0)] = 1
    runs: Annotated[int, Meta(ge=1)] = 1
    """Drives of one vehicle on one road, each with a driver's mood and a day of its own."""
    start: Annotated[dt.datetime, Meta(tz=True)] = dt.datetime(2026, 5, 4, 8, 0, tzinfo=dt.UTC)
    """Of the first run; whole seconds."""
    run_every_h: Annotated[float, Meta(gt=0.0)] = 25.3
    """Not a day, so that the satellites stand elsewhere."""
    road: RoadModel = msgspec.field(default_factory=RoadModel)
    driver: DriverModel = msgspec.field(default_factory=DriverModel)
    weather: Weather = msgspec.field(default_factory=Weather)
    gps: Overlay = {}
    gyro: Overlay = {}
    odometer: Overlay = {}
    torque: Overlay = {}
    barometer: Overlay = {}
    raw: RawModel | None = None
    """What the receiver measures of each satellite; None: it keeps that to itself."""
    events: GpsEvents = msgspec.field(default_factory=GpsEvents)
    damage: Damage = msgspec.field(default_factory=Damage)

    def vehicle_model(self) -> VehicleModel:
        """The vehicle with its load."""
        model = VEHICLES[self.vehicle]
        return msgspec.structs.replace(model, mass_kg=self.mass_kg or model.mass_kg)

    def sensor_models(self) -> Preset:
        """The preset with this scenario's differences, without the sensors that are left out."""
        preset = PRESETS[self.preset]
        return Preset(
            gps=self._overlaid(preset.gps, self.gps, "gps"),
            gyro=self._overlaid(preset.gyro, self.gyro, "gyro"),
            odometer=self._overlaid(preset.odometer, self.odometer, "odometer"),
            torque=self._overlaid(preset.torque, self.torque, "torque"),
            barometer=self._overlaid(preset.barometer, self.barometer, "barometer"),
        )

    def _overlaid(
        self, model: ModelType | None, overlay: Overlay, name: SensorName
    ) -> ModelType | None:
        if model is None or name not in self.sensors:
            return None
        tables = msgspec.to_builtins(model) | overlay
        return fitted(tables, type(model), f"scenario [{name}]")


def overlaid(scenario: Scenario, asked: Overlay) -> Scenario:
    """The scenario with what was asked for on the command line; of `road` only what is given.

    Raises InputError.
    """
    tables = msgspec.to_builtins(scenario, builtin_types=(dt.datetime,)) | asked
    if "road" in asked:
        tables["road"] = msgspec.to_builtins(scenario.road) | asked["road"]
    wanted = fitted(tables, Scenario, "wayline simulate")
    check(wanted, "wayline simulate")
    return wanted


def check(scenario: Scenario, where: str) -> None:
    """Raise InputError for names that are not known and models that do not fit."""
    for key, name, known in (
        ("vehicle", scenario.vehicle, VEHICLES),
        ("preset", scenario.preset, PRESETS),
    ):
        if name not in known:
            raise InputError(where, f"{key} {name!r} is not known", f"give {', '.join(known)}")
    if scenario.start.microsecond:
        raise InputError(where, "start is not a whole second", "leave the fraction out")
    scenario.sensor_models()
