"""Pure: what an engine's torque says of the slope: means of force over short windows.

papers/004 section 3.3: the force of the engine, less what air, rolling and acceleration take, is
what the slope takes (eq. 4.1 to 4.5). The force comes from the balance of powers, which needs
neither the table of gears nor the wheels' radius: F = e T w / v, with the driveline's efficiency e
that divides where the wheels turn the engine (T < 0). Acceleration is the difference of two mean
speeds, each of the readings of half a second; the force is averaged with the very weights that
this difference gives to accelerations: a driver's foot or a slow bus makes no slope.
"""

import math
from typing import NamedTuple

from wayline.drive import Vehicle
from wayline.messages import Odometer, Torque
from wayline.vertical.driveline import REVERSED, Driveline
from wayline.vertical.wheel_noise import WheelNoise
from wayline.vertical.window import Block, Force, weighted_force

GRAVITY_MPS2 = 9.81
AIR_KG_PER_M3 = 1.2
"""Near sea level; a tenth less at 1000 m is 0.05 % of a truck's slope at 20 m/s, in its bias."""
WHEELS_SHARE = 0.025
"""Of the mass: what the wheels' rotation adds to it, for cars and trucks alike."""
ENGINE_KGM2_PER_KG = 1e-4
"""The engine's inertia over the vehicle's mass: 0.15 kgm2 of a car, 3 of a truck."""
SLIP = 0.08
"""Share by which driven wheels turn faster, for a push as large as the weight: a tyre's stiffness
of 25 and half of the weight on driven wheels. Pushing up a crest that begins, they speed up."""
SLOWEST_MPS = 4.0
"""Below, clutch and converter slip and a power over a speed says little."""
HELD_S = 1.0
HELD_NS = 1_000_000_000
"""A value is held so long (SPEC section 2)."""
RATIO_TOLERANCE = 0.05
"""Of engine speed over wheel speed; gears are a fifth apart at least."""
RATIO_SHARE = 0.2
"""What one reading counts for in the mean of that ratio."""
SHORTEST_S, LONGEST_S = 0.5, 4.0
"""Of a block; longer where the wheels' readings are seldom, given up where torque stays away."""
SLOWING_MPS2 = -0.2
"""Without a signal of the brake: who slows down harder without torque may be braking."""
GUST_MPS, GUST_LENGTH_M = 3.0, 80.0
"""Of the wind along the road and the wake of those ahead, alike over so much of the way: 0.5 % of a
car's slope at 30 m/s, 0.1 % of a truck's at 24 m/s. Judgement."""
FEW_SAMPLES_STD = 0.01
"""Of the slope, over the number of torques in a window: between two of them torque changes."""


class Push(NamedTuple):
    """The mean of a window, forces over the weight of the mass that the vehicle is said to have."""

    t_ns: int
    """When it was told."""
    middle_ns: int
    """The instant that the mean is of."""
    length_s: float
    share: float
    """The engine's force at the wheels, less air and the engine's own inertia."""
    level: float
    """What rolling and acceleration take on a level road, over the vehicle's true weight."""
    sampling_std: float
    """One sigma of the slope by few samples and by gusts, without the noise of torque."""
    speed_std_mps: float
    """Of the wheels' speed at either end of the window."""
    goes_on: bool
    """Whether it begins with the speed that ended the window before."""
    behind_m: float
    """How far before the place where it was told its middle lies."""
    is_braked: bool
    """Whether brakes may have held as well: the slope is at most what is told."""


class Propulsion:
    """Takes torques and wheel speeds of one vehicle in order of time, gives a `Push` a window."""

    def __init__(self, vehicle: Vehicle, driveline: Driveline) -> None:
        self._vehicle, self._driveline = vehicle, driveline
        self._weight_n = vehicle.mass_kg * GRAVITY_MPS2
        self._drag_n_per_mps2 = (
            0.5 * AIR_KG_PER_M3 * vehicle.drag_coefficient * vehicle.frontal_area_m2
        )
        self._engine_kgm2 = ENGINE_KGM2_PER_KG * vehicle.mass_kg
        self._noise = WheelNoise(HELD_S, SLOWEST_MPS)
        self._engine_radps = self._speed_mps = 0.0
        self._engine_ns: int | None = None
        self._speed_ns: int | None = None
        self._radians_per_m: float | None = None
        self._tells_overrun = False
        self._before: Block | None = None
        self._block: Block | None = None
        self._goes_on = False

    @property
    def is_slow(self) -> bool:
        """Whether a torque tells nothing at the vehicle's speed."""
        return self._speed_mps < SLOWEST_MPS

    def torque(self, torque: Torque) -> None:
        """Take a message of the engine, which `Driveline.watch` has seen before."""
        if torque.engine_speed_rpm is not None:
            self._engine_radps = torque.engine_speed_rpm * math.pi / 30.0
            self._engine_ns = torque.t_ns
        if not self._driveline.is_joined(torque.t_ns):
            self._give_up()
        if torque.engine_torque_nm is not None:
            self._take(torque.t_ns, torque.engine_torque_nm)

    def _take(self, t_ns: int, torque_nm: float) -> None:
        self._tells_overrun |= torque_nm < 0.0
        radians_per_m = self._turns(t_ns)
        if radians_per_m is None or self._block is None:
            return
        if torque_nm <= 0.0 and not self._tells_overrun:
            # 0 may stand for an engine that is dragged, by nobody knows how much
            self._give_up()
            return
        efficiency = self._vehicle.driveline_efficiency
        through = efficiency if torque_nm >= 0.0 else 1.0 / efficiency
        air_n = self._drag_n_per_mps2 * self._speed_mps**2
        force_n = through * torque_nm * radians_per_m - air_n
        self._block.forces.append(Force(t_ns, force_n, radians_per_m**2))

    def _turns(self, t_ns: int) -> float | None:
        """Radians of the engine for a metre of way; None where it is unknown or has changed."""
        fresh = _is_fresh(self._engine_ns, t_ns) and _is_fresh(self._speed_ns, t_ns)
        if not fresh or self.is_slow:
            return None
        now, before = self._engine_radps / self._speed_mps, self._radians_per_m
        tolerance = RATIO_TOLERANCE + 3.0 * self._noise.std_mps() / self._speed_mps
        if before is None or abs(now - before) > tolerance * before:
            self._radians_per_m = now
            self._driveline.disturb(t_ns)
            self._give_up()
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
            self._driveline.disturb(t_ns, REVERSED)
        if speed_mps < SLOWEST_MPS or not self._driveline.is_joined(t_ns):
            self._give_up()
            return None
        block = self._block
        if block is None or t_ns - block.begin_ns > LONGEST_S * 1e9:
            self._give_up()
            self._block = Block(t_ns)
            return None
        block.read(t_ns, speed_mps)
        block.is_braked |= not self._driveline.is_settled(t_ns)
        if t_ns - block.begin_ns < SHORTEST_S * 1e9 or not block.forces:
            return None
        if self._before is not None and block.middle_ns <= self._before.middle_ns:
            # readings that came late, out of their order
            self._give_up()
            return None
        before, self._before, self._block = self._before, block, Block(t_ns)
        return None if before is None else self._push(before, block)

    def _give_up(self) -> None:
        self._before = self._block = None
        self._goes_on = False

    def _push(self, before: Block, after: Block) -> Push | None:
        t_ns, goes_on, self._goes_on = after.end_ns, self._goes_on, True
        force_n, turns_per_m2, count = weighted_force(before, after)
        length_s = (after.middle_ns - before.middle_ns) * 1e-9
        slipped_mps = self._slip_mps(after.force_n - before.force_n)
        acceleration_mps2 = (after.speed_mps - before.speed_mps - slipped_mps) / length_s
        engine_n = self._engine_kgm2 * turns_per_m2 * acceleration_mps2
        share = (force_n - engine_n) / self._weight_n
        may_brake = not self._driveline.tells_brake and force_n <= 0.0
        middle_ns = (before.middle_ns + after.middle_ns) // 2
        return Push(
            t_ns,
            middle_ns,
            length_s,
            share,
            self._vehicle.rolling_coefficient
            + (1.0 + WHEELS_SHARE) * acceleration_mps2 / GRAVITY_MPS2,
            math.hypot(FEW_SAMPLES_STD / count, self._gust_std(after.speed_mps, length_s)),
            self._noise.std_mps(len(after.speeds_mps)),
            goes_on,
            after.speed_mps * (t_ns - middle_ns) * 1e-9,
            before.is_braked or after.is_braked or (may_brake and acceleration_mps2 < SLOWING_MPS2),
        )

    def _gust_std(self, speed_mps: float, length_s: float) -> float:
        """Of the slope by gusts, as noise of each window that is worth what several share."""
        alike = max(2.0 * GUST_LENGTH_M / (speed_mps * length_s), 1.0)
        per_mps = 2.0 * self._drag_n_per_mps2 * speed_mps / self._weight_n
        return GUST_MPS * per_mps * math.sqrt(alike)

    def _slip_mps(self, further_n: float) -> float:
        """By how much driven wheels turn faster for a further push at the same speed."""
        return SLIP * further_n / self._weight_n * self._speed_mps


def _is_fresh(heard_ns: int | None, t_ns: int) -> bool:
    return heard_ns is not None and t_ns - heard_ns <= HELD_NS
