"""Trip distances of recorded drives by GPS alone, beside speeds added up and wheels."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from wayline_cli.split_table import split_table
from wayline_evaluation.smoothing.smoothers import Method
from wayline_evaluation.smoothing.study import smoothing_study

NDS = """[drive]
vehicle_id = "nds-$id"

[[avl]]
path = "$table"
where = { drive = "$value" }

[avl.columns]
time = "time_utc"
lat_deg = "gps_lat"
lon_deg = "gps_long"
heading_deg = "gps_heading_raw"
speed_mps = { name = "speed_mph", scale = 0.44704 }
satellites = "gps_sats"
hdop = "gps_hdop"
pdop = "gps_pdop"
"""


def test_everyday_drives_agree_with_their_speeds(
    recorded: Callable[[str], Path], tmp_path: Path
) -> None:
    """nds: median 0.2 %, mean 0.5 %, none 2 %; the sum of steps is 2.7 and 24 % off."""
    template = tmp_path / "template.toml"
    template.write_text(NDS)
    table = recorded("nds") / "nds.csv.gz"
    folders = split_table(table, "drive", template, tmp_path / "nds")
    report = smoothing_study(folders, 0, 1, lambda _, __: None)
    assert len(report.trips) == 28
    assert report.bad_fixes == 55
    off_pct = np.array(
        [100.0 * abs(trip.distance_m["rts"] / trip.reference_m - 1.0) for trip in report.trips]
    )
    assert np.median(off_pct) < 0.2
    assert np.mean(off_pct) < 0.5
    assert np.max(off_pct) < 2.0


def test_gps_alone_agrees_with_calibrated_wheels(recorded: Callable[[str], Path]) -> None:
    """css-164: 0.3 %; of the published filters the modified one has the best accelerations."""
    report = smoothing_study([recorded("css-164")], 0, 1, lambda _, __: None)
    assert report.references == {"wheels": 1}
    assert report.methods["rts"].distance.error_max_pct < 0.3
    four: tuple[Method, ...] = ("least_squares_spline", "kernel", "kalman", "modified_kalman")
    figures = [report.methods[name].acceleration_mps2 for name in four]
    absolutes = [each.mean_absolute for each in figures if each is not None]
    assert min(absolutes) == absolutes[3]
