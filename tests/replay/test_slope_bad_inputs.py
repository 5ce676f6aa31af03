"""Inputs of the height that are wrong, from a drive's files to the exported map.

Nothing wrong enters: the map is as good as without the sensor, and claims no more than it holds.
"""

import json
import re
import shutil
from collections.abc import Callable
from functools import reduce
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from wayline.database import open_database
from wayline.errors import InputError
from wayline_evaluation.replays import needed_truth
from wayline_evaluation.slope_map_study import MapAccuracy, map_accuracy
from wayline_replay.replay import replay
from wayline_simulator.drive_folder import simulate
from wayline_simulator.scenario import Scenario, overlaid
from wayline_slope_map.export import ExportRow, export_rows

TRUCK = overlaid(
    Scenario(preset="thesis", vehicle="truck"),
    {"seed": 31, "road": {"kind": "main", "length_m": 6000.0, "open_sky": True}},
)
Edit = Callable[[str], str]
Altitude = Callable[[float, float], float]
"""What is told for a true altitude, so many seconds after the first."""


class Learned(NamedTuple):
    map: MapAccuracy
    rows: list[ExportRow]
    reasons: set[tuple[str, str]]
    """Sensors and why something of them was not used."""


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("truck")
    simulate(TRUCK, folder)
    return folder


@pytest.fixture(scope="module")
def without(drive: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, MapAccuracy]:
    """The map without one sensor; "" is with all."""
    edits = {"": as_is, **{each: unmapped(each) for each in ("torque", "barometer")}}
    return {
        sensor: learned(drive, tmp_path_factory.mktemp("without"), mapping=edit).map
        for sensor, edit in edits.items()
    }


def as_is(text: str) -> str:
    return text


def unmapped(sensor: str) -> Edit:
    return lambda text: re.sub(rf'"{sensor}\..*\n', "", text)


def mapped(quantity: str, how: str) -> Edit:
    """The quantity read otherwise."""
    return lambda text: re.sub(rf'("{re.escape(quantity)}" = .*) }}', rf"\1, {how} }}", text)


def told(altitude: Altitude) -> Edit:
    """The receiver's sentences with other altitudes."""

    def edit(text: str) -> str:
        first_s: list[float] = []
        return "".join(_told_line(line, altitude, first_s) for line in text.splitlines(True))

    return edit


def _told_line(line: str, altitude: Altitude, first_s: list[float]) -> str:
    before, _, rest = line.rstrip("\n").partition("$")
    fields = rest.partition("*")[0].split(",")
    if not fields[0].endswith("GGA") or not fields[9]:
        return line
    clock = fields[1]
    time_s = int(clock[:2]) * 3600.0 + int(clock[2:4]) * 60.0 + float(clock[4:])
    first_s.append(time_s)
    fields[9] = f"{altitude(time_s - first_s[0], float(fields[9])):.1f}"
    body = ",".join(fields)
    return f"{before}${body}*{reduce(lambda sum_, each: sum_ ^ ord(each), body, 0):02X}\n"


def learned(drive: Path, folder: Path, *, mapping: Edit = as_is, gps: Edit = as_is) -> Learned:
    changed = folder / "drive"
    shutil.copytree(drive, changed)
    for name, edit in (("drive.toml", mapping), ("gps.nmea", gps)):
        text = (changed / name).read_text()
        (changed / name).write_text(edit(text))
        assert edit is as_is or edit(text) != text
    url = f"sqlite:///{folder}/slope.db"
    replay(changed, folder / "out", database_url=url)
    engine = open_database(url, "wayline_slope_map", create=False)
    rows = list(export_rows(engine))
    engine.dispose()
    statuses = (folder / "out" / "fusion_status.jsonl").read_text().splitlines()
    verdicts = [each for line in statuses for each in json.loads(line)["verdicts"]]
    reasons = {(each["sensor"], each["reason"]) for each in verdicts if not each["accepted"]}
    return Learned(map_accuracy(rows, needed_truth(drive), 1), rows, reasons)


def is_no_worse(found: MapAccuracy, than: MapAccuracy) -> bool:
    """By error, and by what is claimed beside it."""
    return found.rms_pct < 1.25 * than.rms_pct and found.rms_pct < 1.25 * found.std_pct


@pytest.mark.parametrize(
    ("sensor", "edit", "reason"),
    [
        pytest.param(
            "torque",
            mapped("torque.engine_torque_pct", "scale = -1.0"),
            "the mass would be no such vehicle's",
            id="torque of the wrong sign",
        ),
        pytest.param(
            "torque",
            mapped("torque.engine_torque_pct", "scale = 0.0, offset = 30.0"),
            "the torque does not change, however far the vehicle drives",
            id="torque that is frozen",
        ),
        pytest.param("torque", mapped("torque.gear", "scale = 0.0"), None, id="neutral all along"),
        pytest.param(
            "barometer",
            mapped("barometer.pressure_pa", "scale = 0.01"),
            "no road has such air",
            id="pressure in hPa",
        ),
    ],
)
def test_a_sensor_that_is_wrong_is_as_none(
    drive: Path,
    without: dict[str, MapAccuracy],
    tmp_path: Path,
    *,
    sensor: str,
    edit: Edit,
    reason: str | None,
) -> None:
    found = learned(drive, tmp_path, mapping=edit)
    assert is_no_worse(found.map, without[sensor])
    assert reason is None or (sensor, reason) in found.reasons


@pytest.mark.parametrize(
    ("altitude", "is_told"),
    [
        pytest.param(
            lambda t_s, m: m + 30.0 if 200.0 <= t_s < 240.0 else m, True, id="30 m up for 40 s"
        ),
        pytest.param(lambda t_s, m: 0.0 if 200.0 <= t_s < 205.0 else m, True, id="0.0 for 5 s"),
        pytest.param(
            lambda t_s, m: m + 200.0 * 0.95**t_s, True, id="a cold start's 200 m claimed as few"
        ),
        pytest.param(lambda t_s, m: m + 40.0, False, id="above the ellipsoid"),
    ],
)
def test_altitudes_that_are_wrong_make_no_slope(
    drive: Path,
    without: dict[str, MapAccuracy],
    tmp_path: Path,
    altitude: Altitude,
    is_told: bool,
) -> None:
    found = learned(drive, tmp_path, gps=told(altitude))
    assert is_no_worse(found.map, without[""])
    assert ("gps_altitude" in {sensor for sensor, _ in found.reasons}) is is_told


def test_torque_in_percent_of_nobody_knows_what_is_refused(drive: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has no reference torque; set vehicle"):
        learned(
            drive, tmp_path, mapping=lambda text: re.sub("engine_reference_torque.*\n", "", text)
        )


def test_a_barometer_in_whole_kilopascals_is_as_none(
    without: dict[str, MapAccuracy], tmp_path: Path
) -> None:
    folder = tmp_path / "coarse"
    simulate(overlaid(TRUCK, {"barometer": {"resolution_pa": 1000.0}}), folder)
    assert is_no_worse(learned(folder, tmp_path).map, without["barometer"])


WATER_M = 10_400.0
ABOARD_S = 300.0
"""When the truck is on the ferry; it drives on at once, as if it had slept on board."""


def ferried(text: str) -> str:
    """From then on the receiver is on the other shore, to the north."""
    first_s: list[float] = []
    return "".join(_ferried_line(line, first_s) for line in text.splitlines(True))


def _ferried_line(line: str, first_s: list[float]) -> str:
    before, _, rest = line.rstrip("\n").partition("$")
    fields = rest.partition("*")[0].split(",")
    place = {"GGA": 2, "RMC": 3}.get(fields[0][2:])
    if place is None or not fields[place]:
        return line
    time_s = int(fields[1][:2]) * 3600.0 + int(fields[1][2:4]) * 60.0 + float(fields[1][4:])
    first_s.append(time_s)
    if time_s - first_s[0] < ABOARD_S:
        return line
    lat_deg = int(fields[place][:2]) + float(fields[place][2:]) / 60.0 + WATER_M / 111_200.0
    fields[place] = f"{int(lat_deg):02d}{60.0 * (lat_deg % 1.0):07.4f}"
    body = ",".join(fields)
    return f"{before}${body}*{reduce(lambda sum_, each: sum_ ^ ord(each), body, 0):02X}\n"


def test_a_ferry_makes_no_road_across_the_water(drive: Path, tmp_path: Path) -> None:
    """Bins lie on this shore or on the other one, and say what the road says there."""
    found = learned(drive, tmp_path, gps=ferried)
    truth = needed_truth(drive)
    landed = [
        row._replace(lat_deg=row.lat_deg - WATER_M / 111_200.0)
        for row in found.rows
        if row.lat_deg > float(np.nanmax(truth.lats_deg)) + 0.5 * WATER_M / 111_200.0
    ]
    here = [row for row in found.rows if row.lat_deg <= float(np.nanmax(truth.lats_deg)) + 0.001]
    assert len(landed) > 50
    assert len(here) > 50
    assert len(landed) + len(here) == len(found.rows)
    for shore in (here, landed):
        on_road = map_accuracy(shore, truth, 1)
        assert on_road.bins > 0.9 * len(shore)
        assert on_road.rms_pct < 1.25 * on_road.std_pct


@pytest.mark.parametrize("preset", ["thesis", "mems"])
def test_a_car_park_teaches_no_road(preset: str, tmp_path: Path) -> None:
    """Down a spiral of 12 %, backwards into a bay, and out again: only the street is learned."""
    folder = tmp_path / "garage"
    simulate(overlaid(Scenario(preset=preset), {"seed": 8, "road": {"kind": "garage"}}), folder)
    found = learned(folder, tmp_path)
    steepest_pct = float(np.nanmax(np.abs(needed_truth(folder).grades_pct)))
    assert steepest_pct > 10.0
    assert found.map.bins > 20
    assert found.map.rms_pct < 1.25 * found.map.std_pct
