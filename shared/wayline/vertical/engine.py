"""Pure: a vehicle's engine as an altimeter: what its messages tell of the slope."""

from wayline.drive import Vehicle
from wayline.messages import Odometer, Torque
from wayline.tuning import Tuning
from wayline.vertical.driveline import Driveline
from wayline.vertical.own_slope import OwnSlope, OwnSlopes
from wayline.vertical.propulsion import Propulsion, Push


class Engine:
    """Takes the torques and wheel speeds of one vehicle, of which `vertical_sensors` says which."""

    def __init__(self, vehicle: Vehicle, tuning: Tuning) -> None:
        self._driveline = Driveline()
        self._propulsion = Propulsion(vehicle, self._driveline)
        self._own = OwnSlopes(self._driveline)
        self._uses_torque = "torque" in tuning.vertical_sensors
        self._uses_own = "vehicle" in tuning.vertical_sensors

    def torque(self, torque: Torque) -> OwnSlope | None:
        """Take a message; the vehicle's own slope where it completes a mean."""
        self._driveline.watch(torque)
        if self._uses_torque:
            self._propulsion.torque(torque)
        return self._own.take(torque) if self._uses_own else None

    def wheels(self, odometer: Odometer) -> Push | None:
        """Take a reading of the wheels; what torque has told since the last time, if it is time."""
        return self._propulsion.wheels(odometer) if self._uses_torque else None

    def refusal(self, t_ns: int) -> str | None:
        """Why the torque of an instant tells nothing of the slope; None where that is usual.

        It is where the vehicle is slow, and where torque is not asked at all.
        """
        if not self._uses_torque or self._propulsion.is_slow:
            return None
        return self._driveline.disturbance(t_ns)
