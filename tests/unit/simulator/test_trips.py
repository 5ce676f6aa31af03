"""Simulated trips: that their files say what the model promises, and read back as a drive."""

from pathlib import Path

import numpy as np
import pytest

from unit.simulator.test_network import numbers, rows, texts
from wayline.drive_file import load_drive
from wayline.geo import WGS84
from wayline.messages import GpsFix
from wayline_replay.stream import DriveStream
from wayline_simulator.trips.files import simulate_trips
from wayline_simulator.trips.model import TripsModel
from wayline_simulator.trips.receiver import HOLE_M, holes

MODEL = TripsModel(vehicles=2, trips=3)


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    out = tmp_path_factory.mktemp("trips")
    return [trip.folder for trip in simulate_trips(MODEL, out)]


def test_the_same_seed_makes_the_same_files(folders: list[Path], tmp_path: Path) -> None:
    simulate_trips(MODEL, tmp_path)
    assert texts(tmp_path) == texts(folders[0].parent)


def test_every_trip_is_a_drive_that_reads_back_whole(folders: list[Path]) -> None:
    for folder in folders:
        stream = DriveStream(load_drive(folder), str(folder))
        fixes = [received.message for received in stream]
        assert len(fixes) == len(rows(folder / "fixes.csv"))
        assert all(isinstance(fix, GpsFix) and fix.pdop and fix.satellites for fix in fixes)


def test_good_fixes_lie_near_the_truth_and_those_of_few_satellites_do_not(
    folders: list[Path],
) -> None:
    good, bad = [], []
    for folder in folders:
        told, truth = rows(folder / "fixes.csv"), rows(folder / "truth.csv")
        seconds = (numbers(told, "time") - float(truth[0]["t_s"])).astype(int)
        _, _, off_m = WGS84.inv(
            numbers(told, "lon"),
            numbers(told, "lat"),
            numbers(truth, "lon_deg")[seconds],
            numbers(truth, "lat_deg")[seconds],
        )
        is_bad = (numbers(told, "satellites") < 4) | (numbers(told, "pdop") > 8.0)
        good.append(np.asarray(off_m)[~is_bad])
        bad.append(np.asarray(off_m)[is_bad])
    assert np.percentile(np.concatenate(good), 99) < 15.0
    assert np.median(np.concatenate(bad)) > 20.0
    assert 0.01 < sum(map(len, bad)) / sum(map(len, good)) < 0.15


def test_holes_are_as_long_as_they_may_be_and_never_at_an_end() -> None:
    path_m = np.arange(0.0, 400_000.0, 20.0)
    blind = holes(path_m, np.random.default_rng(2))
    edges = np.flatnonzero(np.diff(blind.astype(int)))
    lengths_m = path_m[edges[1::2]] - path_m[edges[::2]]
    assert len(lengths_m) > 5
    assert lengths_m.min() >= HOLE_M[0] - 40.0
    assert not blind[0]
    assert not blind[-1]
