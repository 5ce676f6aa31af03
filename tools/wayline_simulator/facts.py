"""Pure: what a simulated drive was made with.

Filters never read it; `wayline evaluate` tells it to its yardstick.
"""

from wayline.strict import Strict
from wayline_simulator.barometer import BarometerModel
from wayline_simulator.gps import GpsModel
from wayline_simulator.gyro import GyroModel
from wayline_simulator.happenings import Happenings
from wayline_simulator.loads import LoadChange
from wayline_simulator.odometer import OdometerModel
from wayline_simulator.raw_model import RawModel
from wayline_simulator.torque import TorqueModel
from wayline_simulator.weather import Weather


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
    loads: tuple[LoadChange, ...] = ()
    """Where it became another one on the way."""
    raw: RawModel | None = None
    happenings: Happenings = Happenings()

    @property
    def last_mass_kg(self) -> float:
        """The true mass at the drive's end."""
        last = max(self.loads, key=lambda each: each.distance_m, default=None)
        return self.mass_kg if last is None else last.mass_kg
