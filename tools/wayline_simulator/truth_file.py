"""Writes what really happened: `truth.csv` of SPEC section 3, ten rows a second."""

from pathlib import Path

import numpy as np

from wayline_simulator.journey import Journey

TRUTH_RATE_HZ = 10
COLUMNS = ("t_s", "lat_deg", "lon_deg", "alt_m", "heading_deg", "speed_mps", "grade_pct")
FORMATS = ("%.1f", "%.9f", "%.9f", "%.4f", "%.4f", "%.4f", "%.4f")


def write_truth(journey: Journey, start_s: int, path: Path) -> None:
    """Rows on whole tenths of a second of Unix time, from the first instant to the last."""
    count = int(journey.duration_s * TRUTH_RATE_HZ) + 1
    truth = journey.at(np.arange(count) / TRUTH_RATE_HZ)
    rows = np.column_stack(
        (
            start_s + truth.times_s,
            truth.lats_deg,
            truth.lons_deg,
            truth.alts_m,
            # what rounds up to 360 is north
            np.round(truth.headings_deg, 4) % 360.0,
            truth.speeds_mps,
            truth.grades_pct,
        )
    )
    with path.open("w", encoding="ascii", newline="\n") as file:
        np.savetxt(
            file, rows, fmt=",".join(FORMATS), header=",".join(COLUMNS), comments="", newline="\n"
        )
