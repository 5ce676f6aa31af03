"""Pure: readings of the height that no road can cause, for whoever estimates it."""

PRESSURES_PA = (30_000.0, 120_000.0)
"""From the highest pass to the deepest mine."""
ALTITUDES_M = (-1_000.0, 12_000.0)
NO_SUCH_AIR = "no road has such air"
"""Why a pressure is not used."""


def is_air(pressure_pa: float) -> bool:
    """Whether air on a road can have this pressure; hectopascals for pascals are none."""
    return PRESSURES_PA[0] <= pressure_pa <= PRESSURES_PA[1]


def is_on_earth(alt_m: float) -> bool:
    """Whether a vehicle can be at this altitude."""
    return ALTITUDES_M[0] <= alt_m <= ALTITUDES_M[1]
