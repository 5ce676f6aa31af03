"""How long the tests of faults go on: seconds in `scripts/test`, minutes in `scripts/siege`."""

import os

MINUTES = float(os.environ.get("WAYLINE_SIEGE_MINUTES", "0"))
"""Of the long form; 0 is the short one."""


def lasting_s(short_s: float) -> float:
    """Seconds that a test's fault goes on."""
    return 60.0 * MINUTES if MINUTES else short_s


def examples(short: int) -> int:
    """How many made-up inputs a test tries."""
    return 30 * short if MINUTES else short
