"""The demo's drive: what its devices write, and that the filters find the motion again."""

import csv
import hashlib
import json
from collections.abc import Iterator
from functools import reduce
from pathlib import Path

import cantools
import numpy as np
import pytest
from cantools.database.can import Database

from wayline.air import pressure_altitude_m
from wayline.can_log import CanLog
from wayline.drive import load_drive
from wayline.errors import InputError
from wayline.geo import step_between
from wayline.nmea_log import read_sentences
from wayline.route import load_route
from wayline_cli.demo_can import BAROMETER_OFF_M, GYRO_BIAS_DEGPS, SPEED_READS, pressure_pa
from wayline_cli.demo_drive import write_demo_drive
from wayline_cli.demo_motion import ORIGIN, Motion, drive_lap, lay_out_lap, places_at
from wayline_cli.demo_receiver import TUNNEL_S, sentence, wandering
from wayline_cli.replay import replay


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The drive, written once."""
    folder = tmp_path_factory.mktemp("demo-car")
    write_demo_drive(folder)
    return folder


@pytest.fixture(scope="module")
def motion() -> Motion:
    """The lap at 50 Hz."""
    return drive_lap(50.0)


def test_the_lap_closes() -> None:
    lap = lay_out_lap()
    east_m, north_m, heading_deg = places_at(lap, np.array([0.0, lap.length_m]))
    assert east_m[0] == pytest.approx(east_m[1], abs=1e-6)
    assert north_m[0] == pytest.approx(north_m[1], abs=1e-6)
    assert heading_deg[0] == pytest.approx(heading_deg[1], abs=1e-6)
    assert 1500.0 < lap.length_m < 2000.0


def test_the_car_begins_and_ends_at_rest_in_one_place(motion: Motion) -> None:
    assert motion.speeds_mps[0] == motion.speeds_mps[-1] == 0.0
    ends = (motion.lats_deg[0], motion.lons_deg[0], motion.lats_deg[-1], motion.lons_deg[-1])
    assert step_between(*map(float, ends)).distance_m < 1e-3
    assert motion.alts_m[0] == pytest.approx(motion.alts_m[-1], abs=1e-9)


def test_the_motion_agrees_with_itself(motion: Motion) -> None:
    """Speed, yaw rate and grade are the derivatives of distance, heading and altitude."""
    steps_s = np.diff(motion.times_s)
    travelled_m = np.diff(motion.distances_m)
    middle_mps = (motion.speeds_mps[1:] + motion.speeds_mps[:-1]) / 2.0
    assert travelled_m / steps_s == pytest.approx(middle_mps, abs=0.02)
    turned_deg = np.diff(np.unwrap(motion.headings_deg, period=360.0))
    middle_degps = (motion.yaw_rates_degps[1:] + motion.yaw_rates_degps[:-1]) / 2.0
    # within one instant a bend may begin or end
    assert np.quantile(np.abs(turned_deg / steps_s - middle_degps), 0.99) < 0.1
    places = zip(motion.lats_deg, motion.lons_deg, strict=True)
    east_m, north_m = np.array([ORIGIN.to_plane(*place) for place in places]).T
    assert np.hypot(np.diff(east_m), np.diff(north_m)) == pytest.approx(travelled_m, abs=2e-3)
    risen_m = np.diff(motion.alts_m)
    middle_pct = (motion.grades_pct[1:] + motion.grades_pct[:-1]) / 2.0
    assert risen_m == pytest.approx(travelled_m * middle_pct / 100.0, abs=1e-4)


def test_the_car_moves_as_a_car(motion: Motion) -> None:
    accelerations = np.diff(motion.speeds_mps) / np.diff(motion.times_s)
    assert accelerations.max() < 1.4
    assert accelerations.min() > -1.9
    sideways = np.abs(np.radians(motion.yaw_rates_degps)) * motion.speeds_mps
    assert 2.0 < sideways.max() < 2.3
    assert 4.9 < motion.grades_pct.max() <= 5.0
    assert motion.yaw_rates_degps.min() < -10.0 < 10.0 < motion.yaw_rates_degps.max()


def test_it_stands_twice_on_the_way(motion: Motion) -> None:
    standing = np.diff((motion.speeds_mps == 0.0).astype(int))
    assert np.count_nonzero(standing == 1) == 3  # two stops and the end
    assert 23.0 < np.count_nonzero(motion.speeds_mps == 0.0) / 50.0 < 25.0


def digests(folder: Path) -> dict[str, str]:
    """A fingerprint of every file."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


def test_it_is_the_same_each_time(drive: Path, tmp_path: Path) -> None:
    write_demo_drive(tmp_path)
    assert digests(tmp_path) == digests(drive)
    assert len(digests(drive)) == 6


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="name a folder that can be written"):
        write_demo_drive(tmp_path / "file" / "drive")


def test_a_known_sentence_gets_its_checksum() -> None:
    body = "GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W"
    assert sentence(body) == f"${body}*6A"


def test_every_checksum_is_right(drive: Path) -> None:
    for line in (drive / "gps.nmea").read_text().splitlines():
        body, _, checksum = line.partition("$")[2].partition("*")
        assert int(checksum, 16) == reduce(lambda sum_, letter: sum_ ^ letter, body.encode(), 0)


def test_the_tunnel_has_no_fix_and_the_rest_has(drive: Path) -> None:
    """RMC's status, second by second."""
    texts = [found.text for found in read_sentences(drive / "gps.nmea")]
    states = [text.split(",")[2] for text in texts if text.startswith("$GPRMC")]
    begin, end = map(int, TUNNEL_S)
    assert states == ["A"] * begin + ["V"] * (end - begin) + ["A"] * (len(states) - end)
    assert end - begin == 25


def test_errors_wander_and_close() -> None:
    """About as large as asked, alike from second to second, across the lap's end too."""
    kept = np.exp(-1 / 30)
    errors = wandering(20_000, 1.4, np.random.default_rng(1))
    assert errors.std() == pytest.approx(1.4, rel=0.15)
    following = np.roll(errors, -1)
    assert np.corrcoef(errors, following)[0, 1] == pytest.approx(kept, abs=0.01)
    laps = [wandering(200, 1.4, np.random.default_rng(seed)) for seed in range(200)]
    jumps = [lap[0] - lap[-1] for lap in laps]
    assert np.std(jumps) == pytest.approx(1.4 * np.sqrt(2.0 * (1.0 - kept)), rel=0.2)


def decoded(drive: Path, database: Database, name: str) -> Iterator[float]:
    """Values of one frame's only signal."""
    message = database.get_message_by_name(name)
    for frame in CanLog([drive / "can.log"]):
        if frame.arbitration_id == message.frame_id:
            values = message.decode(frame.data)
            assert isinstance(values, dict)
            yield float(str(next(iter(values.values()))))


def test_the_bus_carries_the_motion_with_its_errors(drive: Path, motion: Motion) -> None:
    database = cantools.database.load_file(drive / "demo-car.dbc")
    assert isinstance(database, Database)
    rates = np.array(list(decoded(drive, database, "Yaw")))
    assert np.mean(rates - motion.yaw_rates_degps) == pytest.approx(GYRO_BIAS_DEGPS, abs=0.01)
    speeds = np.array(list(decoded(drive, database, "Wheels"))) / 3.6
    assert speeds == pytest.approx(motion.speeds_mps[::5] * SPEED_READS, abs=0.002)
    pressures = np.array(list(decoded(drive, database, "Air")))
    assert set(pressures % 10.0) == {0.0}
    seen_m = [pressure_altitude_m(pressure) for pressure in pressures]
    assert seen_m == pytest.approx(motion.alts_m[::25] + BAROMETER_OFF_M, abs=0.45)


def test_pressure_is_the_inverse_of_altitude() -> None:
    alts_m = np.array([-100.0, 0.0, 58.0, 2000.0])
    found = [pressure_altitude_m(float(pressure)) for pressure in pressure_pa(alts_m)]
    assert found == pytest.approx(alts_m, abs=1e-6)


def test_the_route_is_the_lap_with_its_stops(drive: Path) -> None:
    route = load_route(drive / "route.geojson")
    assert route.loop
    assert route.length_m == pytest.approx(lay_out_lap().length_m, rel=0.002)
    assert [stop.stop_id for stop in route.stops] == ["garage", "elm-street", "mill-bridge"]
    assert load_drive(drive).drive.vehicle_id == "demo-car"


def test_fusion_finds_the_motion_again(drive: Path, tmp_path: Path) -> None:
    """Within its own stds on the whole lap, tunnel included, with bias and scale found."""
    replay(drive, tmp_path)
    with (drive / "truth.csv").open() as file:
        truth = {round(float(row["t_s"]) * 10): row for row in csv.DictReader(file)}
    errors_m, modes = [], []
    for line in (tmp_path / "pose.jsonl").read_text().splitlines():
        pose = json.loads(line)
        row = truth[pose["t_ns"] // 100_000_000]
        if pose["mode"] == "starting":
            continue
        modes.append(pose["mode"])
        place = (pose["lat_deg"], pose["lon_deg"], float(row["lat_deg"]), float(row["lon_deg"]))
        errors_m.append(step_between(*place).distance_m)
    assert len(modes) > 1900
    assert modes.count("dead_reckoning") == pytest.approx(240, abs=15)
    assert max(errors_m) < 6.0
    status = json.loads((tmp_path / "fusion_status.jsonl").read_text().splitlines()[-1])
    assert status["gyro_bias_degps"] == pytest.approx(GYRO_BIAS_DEGPS, abs=0.05)
    assert status["odometer_scale"] == pytest.approx(1.0 / SPEED_READS, abs=0.006)
