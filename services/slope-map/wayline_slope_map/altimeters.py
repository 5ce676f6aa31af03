"""Pure: what is measured of the height while a vehicle drives, or left out with the reason."""

import msgspec

from wayline.drive import Vehicle
from wayline.gps_quality import altitude_std_m, has_altitude
from wayline.messages import Barometer, GpsFix, Odometer, Torque
from wayline.tuning import Tuning
from wayline.vertical.engine import Engine
from wayline.vertical.frozen_torque import FROZEN, FrozenTorque
from wayline.vertical.plausible import NO_SUCH_AIR, is_air, is_on_earth
from wayline_slope_map.altitudes import is_hardly_known
from wayline_slope_map.left_out import HARDLY_KNOWN, NOT_ON_EARTH
from wayline_slope_map.track import Altitude, Pressure, Track


class Altimeters:
    """Fills the tracks of one vehicle with what its receivers, barometer and engine tell."""

    def __init__(self, vehicle: Vehicle, tuning: Tuning) -> None:
        self._tuning = tuning
        self._engine = Engine(vehicle, tuning)
        self._frozen = FrozenTorque()

    def take(self, message: msgspec.Struct, source: str, track: Track, driven_m: float) -> None:
        """Take a message; `driven_m` is the distance travelled so far."""
        match message:
            case GpsFix():
                self._take_fix(message, source, track, driven_m)
            case Barometer(pressure_pa=float(pressure_pa)):
                reason = None if is_air(pressure_pa) else NO_SUCH_AIR
                track.left_out.note("barometer", reason, message.t_ns, driven_m, "barometer")
                if reason is None:
                    track.pressures.append(Pressure(message.t_ns, pressure_pa))
            case Odometer():
                if push := self._engine.wheels(message):
                    track.pushes.append(push)
            case Torque():
                self._take_torque(message, track, driven_m)

    def _take_fix(self, fix: GpsFix, source: str, track: Track, driven_m: float) -> None:
        if fix.alt_m is None or not has_altitude(fix):
            return
        altitude = Altitude(fix.t_ns, fix.alt_m, altitude_std_m(fix, self._tuning), source)
        reason = None
        if not is_on_earth(fix.alt_m):
            reason = NOT_ON_EARTH
        elif is_hardly_known(altitude, self._tuning):
            reason = HARDLY_KNOWN
        track.left_out.note(f"gps {source}", reason, fix.t_ns, driven_m, "gps")
        if reason is None:
            track.altitudes.append(altitude)

    def _take_torque(self, torque: Torque, track: Track, driven_m: float) -> None:
        if self._frozen.is_frozen(torque, driven_m):
            track.left_out.note("torque", FROZEN, torque.t_ns, driven_m, "torque")
            return
        if slope := self._engine.torque(torque):
            track.own_slopes.append(slope)
        if torque.engine_torque_nm is not None:
            reason = self._engine.refusal(torque.t_ns)
            track.left_out.note("torque", reason, torque.t_ns, driven_m, "torque")
