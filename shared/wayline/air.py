"""Pure: air pressure and altitude in the ICAO standard atmosphere (ISO 2533)."""

import math

SEA_LEVEL_PA = 101_325.0
EXPONENT = 0.190_263
SCALE_M = 44_330.77


def pressure_altitude_m(pressure_pa: float) -> float:
    """Altitude at which the standard atmosphere has this pressure."""
    return SCALE_M * (1.0 - math.pow(pressure_pa / SEA_LEVEL_PA, EXPONENT))


def metres_per_pascal(pressure_pa: float) -> float:
    """Altitude lost for each pascal gained; 8.4 m for 100 Pa near the ground (papers/004)."""
    return SCALE_M * EXPONENT * math.pow(pressure_pa / SEA_LEVEL_PA, EXPONENT) / pressure_pa
