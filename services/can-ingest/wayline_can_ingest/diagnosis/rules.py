"""Pure: how quantities look in databases of vehicles: names, units, ranges."""

from collections.abc import Mapping
from typing import NamedTuple

SPEEDS = {"km/h": 1 / 3.6, "kph": 1 / 3.6, "kmh": 1 / 3.6, "m/s": 1.0, "mph": 0.44704}
ANGULAR_RATES = {"deg/s": 1.0, "deg/sec": 1.0, "degree/s": 1.0, "rad/s": 57.29577951308232}
PRESSURES = {"kpa": 1e3, "hpa": 1e2, "mbar": 1e2, "bar": 1e5, "pa": 1.0}
DISTANCES = {"km": 1e3, "m": 1.0, "mi": 1609.344}
METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048}
ANGLES = {"deg": 1.0, "degree": 1.0, "degrees": 1.0}
TORQUES = {"nm": 1.0, "n.m": 1.0, "n*m": 1.0}
TURNS = {"rpm": 1.0, "1/min": 1.0, "r/min": 1.0}
NONE = {"": 1.0, "-": 1.0}

RECEIVER = r"gps|gnss|glonass|(^|_)nav|(^|[_.])vp[._]|(^|[_.])vds?[._]|vehicle.?(pos|dir)"
"""A message or signal of a positioning box: its speed is no wheel's."""
JUDGEMENT = r"valid|fault|error|status|quality|accura|offset|(^|_)(std|sigma|qual|crc|checksum)"
"""A signal that says something about another one."""
ENGINE_TORQUE = r"(engine|eng|actual|act|crank).*(torque|trq)"
NO_TORQUE_OF_NOW = (
    r"ref|max|min|demand|driver|request|friction|loss|limit|retard|electric|steer"
    r"|torque.*(mode|ctrl)"
)


class Rule(NamedTuple):
    """Names are regular expressions, searched in `message.signal` in small letters."""

    quantity: str
    names: str
    never: str
    units: Mapping[str, float]
    """To our unit, by the database's; the first one stands in where none is given."""
    least: float
    most: float
    of_receiver: bool | None = False
    """Whether a positioning box says it; None for either."""
    coarsest: float = float("inf")
    """A larger step of the signal is of no use."""
    is_switch: bool = False


RULES = (
    Rule(
        "odometer.speed_mps",
        r"wheel.*(speed|spd)|veh.*(speed|spd)|(speed|spd).*veh|\.speed$",
        r"engine|wind|fan|cruise|set_?sp|limit|target|max|relative|_rel_|lead|wiper|lockout|demand",
        SPEEDS, 0.0, 90.0,
    ),
    Rule(
        "odometer.distance_m", r"odo|total.*dist|dist.*total", r"trip|empty|service|codes",
        DISTANCES, 0.0, 5e9, coarsest=10.0,
    ),
    Rule(
        "gyro.yaw_rate_degps",
        r"yaw.?(rate|velocity)|angular.?(rate|velocity).?z|gyro.?z",
        r"accel|estimat|target|demand", ANGULAR_RATES, -180.0, 180.0, of_receiver=None,
    ),
    Rule(
        "torque.engine_torque_nm", ENGINE_TORQUE, NO_TORQUE_OF_NOW, TORQUES, -2000.0, 6000.0,
    ),
    Rule(
        "torque.engine_torque_pct", ENGINE_TORQUE, NO_TORQUE_OF_NOW, {"%": 1.0}, -125.0, 150.0,
    ),
    Rule(
        "vehicle.engine_reference_torque_nm", r"ref.*(torque|trq)|(torque|trq).*ref",
        r"retard", TORQUES, 20.0, 65_000.0,
    ),
    Rule(
        "torque.engine_speed_rpm", r"(engine|eng).*(speed|spd|rpm)|\.rpm$",
        r"set|limit|target|request|idle|demand|desired", TURNS, 0.0, 12_000.0,
    ),
    Rule("torque.gear_ratio", r"gear.*ratio", r"request|select", NONE, -40.0, 40.0),
    Rule(
        "torque.brake", r"brake.*(pressed|switch|pedal|active)",
        r"park|hand|hold|force|light|request|cmd|release", NONE, 0.0, 1.0, is_switch=True,
    ),
    Rule(
        "barometer.pressure_pa", r"baro|(ambient|atmos).*press", r"relative|altitude",
        PRESSURES, 30_000.0, 115_000.0, of_receiver=None,
    ),
    Rule(
        "gps_fix.lat_deg", r"\.lat(_|deg|$)|latitude|gps.?lat", r"accel|lateral",
        ANGLES, -90.0, 90.0, of_receiver=None,
    ),
    Rule(
        "gps_fix.lon_deg", r"\.lon(g|_|deg|$)|longitude(?!.*accel)|gps.?lon", r"accel|longitudinal",
        ANGLES, -180.0, 180.0, of_receiver=None,
    ),
    Rule(
        "gps_fix.alt_m", r"altitude|\.alt(_|$)", r"accel", METRES, -500.0, 9000.0, of_receiver=True,
    ),
    Rule("gps_fix.speed_mps", r"speed", r"engine|wheel|pitch", SPEEDS, 0.0, 90.0, of_receiver=True),
    Rule(
        "gps_fix.course_deg", r"course|heading|bearing", r"rate", ANGLES, -180.0, 360.0,
        of_receiver=True,
    ),
    Rule("gps_fix.satellites", r"satellites|num.?sat", r"view", NONE, 0.0, 99.0, of_receiver=True),
)  # fmt: skip
