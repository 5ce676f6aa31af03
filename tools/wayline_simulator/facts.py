"""What a simulated drive was made with, kept beside it as `simulation.json`.

Filters never read it; `wayline evaluate` tells it to its yardstick.
"""

from pathlib import Path

import msgspec

from wayline.errors import InputError
from wayline.toml import Strict
from wayline_simulator.barometer import BarometerModel
from wayline_simulator.gps import GpsModel
from wayline_simulator.gyro import GyroModel
from wayline_simulator.happenings import Happenings
from wayline_simulator.odometer import OdometerModel
from wayline_simulator.torque import TorqueModel
from wayline_simulator.weather import Weather

FILE_NAME = "simulation.json"


class Facts(Strict, frozen=True, kw_only=True):
    """The models of the sensors, not the errors that were drawn from them."""

    preset: str
    seed: int
    run: int
    gps: GpsModel | None
    gyro: GyroModel | None
    odometer: OdometerModel | None
    torque: TorqueModel | None
    barometer: BarometerModel | None
    weather: Weather
    mass_kg: float
    """The vehicle's true mass; drive.toml has it with the model's error."""
    happenings: Happenings = Happenings()


def write_facts(facts: Facts, folder: Path) -> None:
    """Write them beside the drive."""
    data = msgspec.json.format(msgspec.json.encode(facts), indent=2)
    (folder / FILE_NAME).write_bytes(data + b"\n")


def read_facts(folder: Path) -> Facts | None:
    """Of a simulated drive; None where the drive is a recorded one. Raises InputError."""
    path = folder / FILE_NAME
    if not path.exists():
        return None
    try:
        return msgspec.json.decode(path.read_bytes(), type=Facts)
    except msgspec.DecodeError as error:
        raise InputError(str(path), str(error), "simulate the drive again") from None
