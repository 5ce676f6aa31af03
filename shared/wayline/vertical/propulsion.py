"""Pure: what an engine's torque says of the slope: means of force over short windows.

papers/004 section 3.3: the force of the engine, less what air, rolling and acceleration take, is
what the slope takes (eq. 4.1 to 4.5). The force comes from the balance of powers, which needs
neither the table of gears nor the wheels' radius: F = e T w / v, with the driveline's efficiency e
that divides where the wheels turn the engine (T < 0). Means over windows between two readings of
the wheels, because acceleration is a difference of speeds, and torque may come 100 times a second.
"""

import math
from typing import NamedTuple

from wayline.drive import Vehicle
from wayline.messages import Odometer, Torque
from wayline.resolution import Resolution
from wayline.vertical.driveline import Driveline

GRAVITY_MPS2 = 9.81
AIR_KG_PER_M3 = 1.2
"""Near sea level; a tenth less at 1000 m is 0.05 % of a truck's slope at 20 m/s, in its bias."""
WHEELS_SHARE = 0.025
"""Of the mass: what the wheels' rotation adds to it, for cars and trucks alike."""
ENGINE_KGM2_PER_KG = 1e-4
"""The engine's inertia over the vehicle's mass: 0.15 kgm2 of a car, 3 of a truck."""
SLOWEST_MPS = 4.0
"""Below, clutch and converter slip and a power over a speed says little."""
HELD_NS = 1_000_000_000
"""A value is held so long (SPEC section 2)."""
RATIO_TOLERANCE = 0.05
"""Of engine speed over wheel speed; gears are a fifth apart at least."""
RATIO_SHARE = 0.2
"""What one reading counts for in the mean of that ratio."""
SHORTEST_S, LONGEST_S = 0.5, 4.0
"""Of a window; longer where the wheels' steps are coarse, given up where torque stays away."""
NOISE_READINGS = 100.0
"""Over which the noise of the wheels is learned."""
COARSEST_STD_MPS = 0.08
"""Of steps of 1 km/h; until enough is read, steps seem larger."""
JERK_MPS = 0.15
"""Of a second difference at most: more is a driver's foot, not noise."""
SLOWING_MPS2 = -0.2
"""Without a signal of the brake: who slows down harder without torque may be braking."""
REMEMBERED_S = 3.0
"""Over which the windows before are averaged: longer than a filter needs to follow a slope."""
FEW_SAMPLES_STD = 0.01
"""Of the slope, over the number of torques in a window: between two of them torque changes."""


class Push(NamedTuple):
    """The mean of a window, forces over the weight of the mass that the vehicle is said to have."""

    t_ns: int
    """The window's end."""
    length_s: float
    share: float
    """The engine's force at the wheels, less air and the engine's own inertia."""
    level: float
    """What rolling and acceleration take on a level road, over the vehicle's true weight."""
    sampling_std: float
    """One sigma of the slope by few samples, without the noise of torque."""
    speed_std_mps: float
    """Of the wheels' speed at either end of the window."""
    goes_on: bool
    """Whether it begins with the reading that ended the window before."""
    share_before: float
    """Mean of the windows before, over some seconds; 0 where none led up to this one."""
    behind_m: float
    """How far before the window's end its middle lies."""

    @property
    def middle_ns(self) -> int:
        """The instant that the mean is of."""
        return self.t_ns - round(0.5e9 * self.length_s)


class _Window:
    """Sums since a reading of the wheels."""

    def __init__(self, t_ns: int, speed_mps: float, *, goes_on: bool) -> None:
        self.t_ns, self.speed_mps, self.goes_on = t_ns, speed_mps, goes_on
        self.count = 0
        self.force_n = self.turns_per_m2 = 0.0

    def add(self, force_n: float, radians_per_m: float) -> None:
        """One torque's force, and how far the engine turns for a metre."""
        self.count += 1
        self.force_n += force_n
        self.turns_per_m2 += radians_per_m**2


class SpeedNoise:
    """White noise and steps of the wheels' speed, by its second differences."""

    def __init__(self) -> None:
        self._steps = Resolution(1e-4)
        self._variance = 0.0
        self._weight = 0.0
        self._before: tuple[int, float] | None = None
        self._change: tuple[float, float] | None = None
        """Of the speed, and in what time."""

    @property
    def std_mps(self) -> float:
        """One sigma."""
        return max(math.sqrt(self._variance), min(self._steps.std, COARSEST_STD_MPS))

    def learn(self, t_ns: int, speed_mps: float) -> None:
        """Take a reading into account."""
        self._steps.learn(speed_mps)
        before, self._before = self._before, (t_ns, speed_mps)
        if before is None or not 0 < t_ns - before[0] <= HELD_NS:
            self._change = None
            return
        earlier, self._change = self._change, (speed_mps - before[1], (t_ns - before[0]) * 1e-9)
        if earlier is None or speed_mps < SLOWEST_MPS:
            return
        second_mps = self._change[0] - earlier[0] * self._change[1] / earlier[1]
        self._weight = min(self._weight + 1.0, NOISE_READINGS)
        sample = min(abs(second_mps), JERK_MPS) ** 2 / 6.0
        self._variance += (sample - self._variance) / self._weight


class Propulsion:
    """Takes torques and wheel speeds of one vehicle in order of time, gives a `Push` a window."""

    def __init__(self, vehicle: Vehicle, driveline: Driveline) -> None:
        self._vehicle, self._driveline = vehicle, driveline
        self._weight_n = vehicle.mass_kg * GRAVITY_MPS2
        self._drag_n_per_mps2 = (
            0.5 * AIR_KG_PER_M3 * vehicle.drag_coefficient * vehicle.frontal_area_m2
        )
        self._engine_kgm2 = ENGINE_KGM2_PER_KG * vehicle.mass_kg
        self._noise = SpeedNoise()
        self._engine_radps = self._speed_mps = 0.0
        self._engine_ns: int | None = None
        self._speed_ns: int | None = None
        self._radians_per_m: float | None = None
        self._share_before = 0.0
        self._tells_overrun = False
        self._window: _Window | None = None

    def torque(self, torque: Torque) -> None:
        """Take a message of the engine, which `Driveline.watch` has seen before."""
        if torque.engine_speed_rpm is not None:
            self._engine_radps = torque.engine_speed_rpm * math.pi / 30.0
            self._engine_ns = torque.t_ns
        if not self._driveline.is_settled(torque.t_ns):
            self._window = None
        if torque.engine_torque_nm is not None:
            self._take(torque.t_ns, torque.engine_torque_nm)

    def _take(self, t_ns: int, torque_nm: float) -> None:
        self._tells_overrun |= torque_nm < 0.0
        radians_per_m = self._turns(t_ns)
        window = self._window
        if radians_per_m is None or window is None:
            return
        if torque_nm <= 0.0 and not self._tells_overrun:
            # 0 may stand for an engine that is dragged, by nobody knows how much
            self._window = None
            return
        efficiency = self._vehicle.driveline_efficiency
        through = efficiency if torque_nm >= 0.0 else 1.0 / efficiency
        air_n = self._drag_n_per_mps2 * self._speed_mps**2
        window.add(through * torque_nm * radians_per_m - air_n, radians_per_m)

    def _turns(self, t_ns: int) -> float | None:
        """Radians of the engine for a metre of way; None where it is unknown or has changed."""
        fresh = _is_fresh(self._engine_ns, t_ns) and _is_fresh(self._speed_ns, t_ns)
        if not fresh or self._speed_mps < SLOWEST_MPS:
            return None
        now, before = self._engine_radps / self._speed_mps, self._radians_per_m
        tolerance = RATIO_TOLERANCE + 3.0 * self._noise.std_mps / self._speed_mps
        if before is None or abs(now - before) > tolerance * before:
            self._radians_per_m = now
            self._driveline.disturb(t_ns)
            self._window = None
            return None
        self._radians_per_m = before + RATIO_SHARE * (now - before)
        return self._radians_per_m

    def wheels(self, odometer: Odometer) -> Push | None:
        """Take a reading of the wheels; what the window that it ends has told."""
        speed_mps, t_ns = odometer.speed_mps, odometer.t_ns
        if speed_mps is None:
            return None
        self._noise.learn(t_ns, speed_mps)
        self._speed_mps, self._speed_ns = speed_mps, t_ns
        if odometer.reverse:
            self._driveline.disturb(t_ns)
        if speed_mps < SLOWEST_MPS or not self._driveline.is_settled(t_ns):
            self._window = None
            return None
        window = self._window
        length_s = 0.0 if window is None else (t_ns - window.t_ns) * 1e-9
        if window is None or length_s > LONGEST_S:
            self._window = _Window(t_ns, speed_mps, goes_on=False)
            return None
        if length_s < SHORTEST_S or not window.count:
            return None
        self._window = _Window(t_ns, speed_mps, goes_on=True)
        return self._push(window, t_ns, speed_mps, length_s)

    def _push(self, window: _Window, t_ns: int, speed_mps: float, length_s: float) -> Push | None:
        acceleration_mps2 = (speed_mps - window.speed_mps) / length_s
        force_n = window.force_n / window.count
        if not self._driveline.tells_brake and force_n <= 0.0 and acceleration_mps2 < SLOWING_MPS2:
            return None
        engine_n = self._engine_kgm2 * window.turns_per_m2 / window.count * acceleration_mps2
        rolling = self._vehicle.rolling_coefficient
        share = (force_n - engine_n) / self._weight_n
        before = self._share_before if window.goes_on else 0.0
        kept = math.exp(-length_s / REMEMBERED_S) if window.goes_on else 0.0
        self._share_before = share + kept * (before - share)
        return Push(
            t_ns,
            length_s,
            share,
            rolling + (1.0 + WHEELS_SHARE) * acceleration_mps2 / GRAVITY_MPS2,
            FEW_SAMPLES_STD / window.count,
            self._noise.std_mps,
            window.goes_on,
            before,
            0.25 * (speed_mps + window.speed_mps) * length_s,
        )


def _is_fresh(heard_ns: int | None, t_ns: int) -> bool:
    return heard_ns is not None and t_ns - heard_ns <= HELD_NS
