"""Inputs of the height that are wrong, from a drive's files to the exported map.

Nothing wrong enters: the map is as good as without the sensor, and claims no more than it holds.
"""

import json
import re
import shutil
from collections import Counter
from collections.abc import Callable, Mapping
from functools import reduce
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from wayline.database import open_database
from wayline.errors import InputError
from wayline.vertical.driveline import REVERSED, UNJOINED
from wayline.vertical.frozen_torque import FROZEN
from wayline.vertical.plausible import NO_SUCH_AIR
from wayline.vertical.trust import NO_SUCH_MASS
from wayline_evaluation.reference import Reference
from wayline_evaluation.replays import needed_truth
from wayline_evaluation.slope_map_study import MapAccuracy, map_accuracy
from wayline_replay.replay import replay
from wayline_simulator.course import STEP_M, Halt, Surroundings
from wayline_simulator.drive_folder import simulate
from wayline_simulator.garage import RELIEF
from wayline_simulator.road_plan import RoadPlan
from wayline_simulator.scenario import Scenario, overlaid
from wayline_simulator.vertical_alignment import join_grades
from wayline_slope_map.export import ExportRow, export_rows
from wayline_slope_map.left_out import COARSE, LEAPT, WALKED, LeftOut
from wayline_slope_map.left_out_rows import every

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
    """Sensors and why something of them was not used live."""
    left_out: list[LeftOut]
    """Of the map."""
    counted: Mapping[str, int]
    """In the summary: what of the map was left out, by reason."""

    @property
    def why(self) -> set[tuple[str | None, str]]:
        """Sensors, None for all, and why something of them was left out of the map."""
        return {(each.sensor, each.reason) for each in self.left_out}


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
    summary = replay(changed, folder / "out", database_url=url)
    engine = open_database(url, "wayline_slope_map", create=False)
    rows = list(export_rows(engine))
    with engine.connect() as connection:
        left_out = every(connection)
    engine.dispose()
    statuses = (folder / "out" / "fusion_status.jsonl").read_text().splitlines()
    verdicts = [each for line in statuses for each in json.loads(line)["verdicts"]]
    reasons = {(each["sensor"], each["reason"]) for each in verdicts if not each["accepted"]}
    counted = summary.left_out["slope-map"]
    assert counted == Counter(each.reason for each in left_out)
    return Learned(map_accuracy(rows, needed_truth(drive), 1), rows, reasons, left_out, counted)


def is_no_worse(found: MapAccuracy, than: MapAccuracy) -> bool:
    """By error, and by what is claimed beside it."""
    return found.rms_pct < 1.25 * than.rms_pct and found.rms_pct < 1.25 * found.std_pct


@pytest.mark.parametrize(
    ("sensor", "edit", "reason"),
    [
        pytest.param(
            "torque",
            mapped("torque.engine_torque_pct", "scale = -1.0"),
            NO_SUCH_MASS,
            id="torque of the wrong sign",
        ),
        pytest.param(
            "torque",
            mapped("torque.engine_torque_pct", "scale = 0.0, offset = 30.0"),
            FROZEN,
            id="torque that is frozen",
        ),
        pytest.param("torque", mapped("torque.gear", "scale = 0.0"), UNJOINED, id="neutral"),
        pytest.param(
            "barometer",
            mapped("barometer.pressure_pa", "scale = 0.01"),
            NO_SUCH_AIR,
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
    reason: str,
) -> None:
    found = learned(drive, tmp_path, mapping=edit)
    assert is_no_worse(found.map, without[sensor])
    assert reason == UNJOINED or (sensor, reason) in found.reasons
    assert found.why == {(sensor, reason)}
    assert sum(each.length_m for each in found.left_out) > 5_000.0


def test_of_a_drive_on_which_all_is_well_nothing_is_left_out(drive: Path, tmp_path: Path) -> None:
    found = learned(drive, tmp_path)
    assert found.left_out == []
    assert found.counted == {}


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
    found = learned(folder, tmp_path)
    assert is_no_worse(found.map, without["barometer"])
    assert found.why == {("barometer", COARSE)}


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
    (leap,) = (each for each in found.left_out if each.reason == LEAPT)
    assert None not in (leap.start_lat_deg, leap.end_lat_deg)
    across_m = ((leap.end_lat_deg or 0.0) - (leap.start_lat_deg or 0.0)) * 111_200.0
    assert across_m == pytest.approx(WATER_M, rel=0.02)
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
    walked = [each for each in found.left_out if each.reason == WALKED]
    assert sum(each.length_m for each in walked) > 1_500.0
    assert walked[0].start_lat_deg is not None


BACK_M = 300.0
PARTS = ((800.0, 0.0), (700.0, 0.04), (BACK_M, 0.04), (BACK_M, 0.04), (900.0, 0.0))
"""Lengths, and slopes of the nose: up a hill, back by 300 m, and on. The third is the way back."""


def there_and_back(_: np.random.Generator) -> RoadPlan:
    samples = [round(length_m / STEP_M) for length_m, _ in PARTS]
    ends = np.cumsum(samples)
    count = int(ends[-1]) + 1
    backwards = np.append(np.repeat([False, False, True, False, False], samples), False)
    slopes = np.array([slope for _, slope in PARTS])
    return RoadPlan(
        curvature_per_m=np.zeros(count),
        grade=join_grades(count, ends[:-1] * STEP_M, slopes, RELIEF),
        limits_mps=np.full(count, 16.0),
        surroundings=np.full(count, Surroundings.OPEN, dtype=np.int8),
        halts=[Halt(1_500.0, "turn", 3.0), Halt(1_500.0 + BACK_M, "turn", 3.0)],
        backwards=backwards,
    )


@pytest.mark.parametrize(
    ("reverse_mps", "is_told", "reason"),
    [
        pytest.param(2.0, True, (None, WALKED), id="slowly, told by the bus"),
        pytest.param(6.0, True, ("torque", REVERSED), id="fast, told by the bus"),
        pytest.param(6.0, False, (None, LEAPT), id="fast, by a bus that does not tell"),
    ],
)
def test_a_drive_in_reverse_teaches_no_slope_of_the_other_way(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    *,
    reverse_mps: float,
    is_told: bool,
    reason: tuple[str | None, str],
) -> None:
    """Up a hill, 300 m back and on: what falls is learned as falling, and no road is made up."""
    monkeypatch.setattr("wayline_simulator.road.garage_road", there_and_back)
    driven = {
        "seed": 5,
        "road": {"kind": "garage"},
        "driver": {"reverse_mps": reverse_mps},
        "odometer": {"reverse_reported": is_told},
    }
    folder = tmp_path / "there-and-back"
    simulate(overlaid(Scenario(preset="mems", vehicle="truck"), driven), folder)
    forgotten = r"\[route\]\npath.*\n" if is_told else r'\[route\]\npath.*\n|"torque.gear".*\n'
    found = learned(folder, tmp_path, mapping=lambda text: re.sub(forgotten, "", text))
    assert reason in found.why
    errors_pct = np.abs(beside_the_hill(found.rows, needed_truth(folder)))
    assert len(errors_pct) > 100
    assert float(np.sqrt(np.mean(np.square(errors_pct)))) < 0.6
    assert np.count_nonzero(errors_pct > 2.0) <= 3


def beside_the_hill(rows: list[ExportRow], truth: Reference) -> list[float]:
    """Errors of bins in percent; a slope that is taken for its opposite is off by 8 %.

    The truth's heading is the nose's, to whose side the road rises, whichever way it goes.
    """
    errors_pct = []
    for row in rows:
        apart = np.hypot(truth.lats_deg - row.lat_deg, 0.5 * (truth.lons_deg - row.lon_deg))
        at = int(np.argmin(apart))
        is_with_nose = np.cos(np.radians(row.heading_deg - truth.headings_deg[at])) > 0.0
        climb_pct = abs(float(truth.grades_pct[at]))
        errors_pct.append(row.grade_pct - (climb_pct if is_with_nose else -climb_pct))
    return errors_pct
