"""Reads which trip of a timetable a vehicle really ran, from its drive's truth.csv."""

import csv
from pathlib import Path

import numpy as np

from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline_evaluation.trips import TripTruth

NEEDED = ("t_s", "lat_deg", "lon_deg", "trip_id")
MEND = "name drives of wayline simulate network, or add the columns"


def read_trip_truth(folder: Path) -> TripTruth:
    """The trips of a drive's truth. Raises InputError where it does not tell them."""
    drive = load_drive(folder)
    if drive.truth is None:
        raise InputError(str(folder), "has no truth", MEND)
    path = Path(drive.truth.path)
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        columns = [[row[name] for row in rows] for name in NEEDED]
        times_s, lats_deg, lons_deg = (np.array(column, np.float64) for column in columns[:3])
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), f"cannot be read ({error})", "check the file") from None
    except KeyError as error:
        raise InputError(str(path), f"no column {error.args[0]}", MEND) from None
    except ValueError as error:
        raise InputError(str(path), str(error), "write numbers in every row") from None
    if len(times_s) < 2 or not np.all(np.diff(times_s) > 0.0):
        raise InputError(str(path), "t_s does not increase over two rows", "sort its rows")
    return TripTruth(times_s, lats_deg, lons_deg, np.array(columns[3]))
