"""Who knows more than eta: all other laps of a loop, or the streets of a simulated network."""

from pathlib import Path

import numpy as np
import pytest

from unit.eta.route_drives import SQUARE, route_of
from wayline.errors import InputError
from wayline.messages import Progress, StopEvent
from wayline.route import Route
from wayline_evaluation.eta_study import Followed, eta_study
from wayline_evaluation.eta_yardstick import expect_yardstick, other_laps, told_streets
from wayline_evaluation.other_laps import OtherLaps
from wayline_evaluation.reference import Reference
from wayline_evaluation.replays import Options
from wayline_evaluation.told_streets import ToldStreets
from wayline_evaluation.truth import read_truth
from wayline_simulator.network.model import NetworkModel
from wayline_simulator.network.simulation import make_network, ride_of, traffic_of

START_S = 1_700_000_000
NS = 1_000_000_000
LAP_M = 1_000.0
LAPS_S = (100, 120, 200)
"""Each driven evenly."""


def loop() -> tuple[list[Progress], list[StopEvent]]:
    """Three laps from stop A on, B halfway; on the second it stands at B for the last 20 s."""
    progress, events, begun_s = [], [], START_S
    for lap, lap_s in enumerate(LAPS_S):
        stands_s = 20 if lap == 1 else 0
        drives_s = lap_s - stands_s
        for second in range(lap_s):
            halfway = drives_s // 2
            driven_s = second if second < halfway else max(second - stands_s, halfway)
            progress.append(at((begun_s + second), lap, LAP_M * driven_s / drives_s))
        events += [came(begun_s, "A", lap), came(begun_s + drives_s / 2, "B", lap)]
        begun_s += lap_s
    return progress, [*events, came(begun_s, "A", len(LAPS_S))]


def at(t_s: float, lap: int, distance_m: float) -> Progress:
    return Progress(
        t_ns=round(t_s * NS),
        route_id="R",
        distance_m=distance_m,
        lap=lap,
        lat_deg=48.0,
        lon_deg=11.0,
        cross_track_m=0.0,
        distance_std_m=1.0,
        on_route=True,
        speed_mps=8.0,
    )


def came(t_s: float, stop_id: str, lap: int) -> StopEvent:
    return StopEvent(
        t_ns=round(t_s * NS),
        route_id="R",
        stop_id=stop_id,
        stop_sequence=1 + "AB".index(stop_id),
        kind="arrived",
        distance_m=0.0,
        lap=lap,
    )


def test_other_laps_say_how_long_it_is_from_the_same_place() -> None:
    """A quarter of the first lap has been driven: to B the others took 25 and 50 s."""
    told_s = OtherLaps(*loop()).arrivals_s("B", START_S + 25.0) - (START_S + 25.0)
    assert sorted(told_s.tolist()) == pytest.approx([25.0, 50.0], abs=1.5)


def test_other_laps_count_how_long_it_has_stood() -> None:
    """Five seconds at B, where the other laps did not stand: half of their time is left."""
    begun_s = START_S + LAPS_S[0]
    told_s = OtherLaps(*loop()).arrivals_s("A", begun_s + 55.0) - (begun_s + 55.0)
    assert sorted(told_s.tolist()) == pytest.approx([50.0, 100.0], abs=2.5)


def test_some_drives_have_no_yardstick(tmp_path: Path) -> None:
    """A recorded one without a truth, or with less than three laps."""
    progress, events = loop()
    once = [each for each in progress if each.lap < 2]
    assert other_laps([], []) is None
    assert other_laps(once, events) is None
    assert other_laps(progress, events) is not None
    assert told_streets(tmp_path) is None


def driven(folder: Path, laps: int, route: Route) -> Reference:
    """The truth of some laps."""
    corners = list(zip(route.line.lats_deg.tolist(), route.line.lons_deg.tolist(), strict=True))
    places = [*corners[:-1] * laps, corners[0]]
    rows = [f"{100.0 * at},{lat_deg},{lon_deg}" for at, (lat_deg, lon_deg) in enumerate(places)]
    path = folder / "truth.csv"
    path.write_text("\n".join(("t_s,lat_deg,lon_deg", *rows)), encoding="utf-8")
    return read_truth(path)


def test_a_drive_without_a_yardstick_is_told_by_what_it_holds(tmp_path: Path) -> None:
    """Without a truth, after one lap, or on a line that does not go round."""
    loop, line = route_of(SQUARE), route_of(SQUARE[:2])
    expect_yardstick(tmp_path, driven(tmp_path, 2, loop), [line, loop])
    for truth, route in ((None, loop), (driven(tmp_path, 1, loop), loop), (None, line)):
        with pytest.raises(InputError, match="no yardstick"):
            expect_yardstick(tmp_path, truth, [route])


def test_a_drive_without_a_yardstick_is_refused_before_it_is_replayed(tmp_path: Path) -> None:
    (tmp_path / "gps.nmea").touch()
    drive = '[drive]\nvehicle_id = "bus"\n[[nmea]]\npath = "gps.nmea"\ndate = 2026-06-03\n'
    (tmp_path / "drive.toml").write_text(drive)
    asked = Options(out=tmp_path / "out", yardstick=True)
    with pytest.raises(InputError, match="no yardstick"):
        eta_study([tmp_path], Followed(), asked, lambda done, total: None)
    assert not (tmp_path / "out").exists()


def test_who_is_told_the_streets_knows_how_likely_each_arrival_is() -> None:
    """Over a morning of three buses: as often late as early, eight in ten within p10 and p90."""
    model = NetworkModel(seed=17, vehicles=3, hours=3.0)
    network, random = make_network(model), np.random.default_rng(1)
    traffic, shares = traffic_of(model, network, 1), []
    for vehicle in (1, 2, 3):
        ride = ride_of(model, network, traffic, vehicle)
        assert ride is not None
        came_s = {(visit.trip_id, visit.stop_id): visit.arrives_s for visit in ride.visits}
        for stage in ride.stages:
            if stage.trip is None:
                continue
            streets = ToldStreets(stage, stage.trip, traffic)
            for time_s in np.arange(stage.begins_s + 1.0, stage.ends_s, 240.0):
                found = streets.arrivals_s(float(time_s), random)
                shares += [
                    np.mean(each_s < came_s[stage.trip.trip_id, stop_id])
                    for stop_id, each_s in found.items()
                ]
    assert len(shares) > 500
    assert np.mean(shares) == pytest.approx(0.5, abs=0.06)
    assert np.mean((np.array(shares) > 0.1) & (np.array(shares) < 0.9)) == pytest.approx(
        0.8, abs=0.06
    )
