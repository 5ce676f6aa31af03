"""Pure: a trip's distance in words."""

KM_M = 1_000.0
DIGITS_MAX = 3


def in_km(distance_m: float, distance_std_m: float) -> str:
    """`12.3 +/- 0.1`: kilometres and one sigma of them, with as many digits as that has."""
    std_km = distance_std_m / KM_M
    digits = next((n for n in range(1, DIGITS_MAX) if std_km >= 0.5 * 10.0**-n), DIGITS_MAX)
    return f"{distance_m / KM_M:,.{digits}f} +/- {std_km:.{digits}f}"
