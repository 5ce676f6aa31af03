"""How trips that were told are scored, on two lines that fork after 2 km."""

from pathlib import Path

import numpy as np
import pytest

from unit.eta.rides import two_lines
from unit.timetable.faulty_feeds import LAT_DEG, LON_DEG
from wayline.errors import InputError
from wayline.messages import GpsFix, Progress
from wayline.timetable.calendar import SECOND_NS
from wayline.timetable.model import Timetable
from wayline.timetable.reading import read_timetable
from wayline_evaluation.trip_truth import read_trip_truth
from wayline_evaluation.trips import TripScore, TripTruth, trip_run

START_S = 1_780_000_000
SPEED_MPS = 10.0
NORTH_M = 111_194.9
SECONDS = 400
"""To the north by T, past the fork at 200 s."""


@pytest.fixture
def timetable(tmp_path: Path) -> Timetable:
    two_lines(tmp_path)
    return read_timetable(tmp_path)


def truth(*, idle_s: int = 0) -> TripTruth:
    """Without a trip for so many seconds, then T."""
    seconds = np.arange(SECONDS, dtype=np.float64)
    trips = np.where(seconds < idle_s, "", "T")
    lats_deg = LAT_DEG + SPEED_MPS * seconds / NORTH_M
    return TripTruth(START_S + seconds, lats_deg, np.full(SECONDS, LON_DEG), trips)


def progress(second: int, trip_id: str | None, direction_id: int = 0) -> Progress:
    return Progress(
        t_ns=(START_S + second) * SECOND_NS,
        route_id="R",
        trip_id=trip_id,
        distance_m=0.0,
        lat_deg=LAT_DEG,
        lon_deg=LON_DEG,
        cross_track_m=0.0,
        distance_std_m=1.0,
        on_route=True,
        speed_mps=0.0,
        direction_id=1 if direction_id else 0,
    )


def score(of: TripTruth, told: list[Progress], timetable: Timetable) -> TripScore:
    fixes = [
        GpsFix(t_ns=(START_S + second) * SECOND_NS, valid=True, lat_deg=1.0, lon_deg=1.0)
        for second in range(0, SECONDS, 20)
    ]
    return trip_run("bus", of, told, fixes, [timetable]).score


def test_alone_begins_a_kilometre_behind_the_fork(timetable: Timetable) -> None:
    """The fork is at 2.0 km, and 60 m further the other line is another street: at 306 s."""
    told = [progress(second, "T" if second < 310 else "V") for second in range(SECONDS)]
    scored = score(truth(), told, timetable)
    assert scored.told_share == 1.0
    assert scored.right_share == pytest.approx(310 / SECONDS)
    assert scored.alone_share == pytest.approx((310 - 306) / (SECONDS - 306), abs=0.05)
    assert scored.later_share == scored.alone_share


def test_what_is_not_told_is_not_right(timetable: Timetable) -> None:
    told = [progress(second, None if second % 2 else "T") for second in range(SECONDS)]
    scored = score(truth(), told, timetable)
    assert (scored.told_share, scored.right_share) == (0.5, 0.5)


def test_a_trip_that_is_told_of_a_vehicle_without_one_is_idle(timetable: Timetable) -> None:
    told = [progress(second, "T") for second in range(50, SECONDS)]
    scored = score(truth(idle_s=100), told, timetable)
    assert scored.idle_share == 0.5
    assert scored.right_share == 1.0


def test_a_layover_is_not_driven(timetable: Timetable) -> None:
    """A trip that begins where the vehicle is alone is told 60 m later: that is no fault."""
    of = truth()
    trips = np.where(np.arange(SECONDS) < 350, "V", "T")
    told = [progress(second, "T" if second >= 356 else "V") for second in range(SECONDS)]
    scored = score(TripTruth(of.times_s, of.lats_deg, of.lons_deg, trips), told, timetable)
    assert scored.alone_share is not None
    assert scored.alone_share < 1.0
    assert scored.alone_driven_share == 1.0


def test_another_direction_is_counted_in_reports(timetable: Timetable) -> None:
    """From 95 to 165 s: behind the fixes at 80 (its last second), 100, 120 and 140 s."""
    told = [progress(second, None, int(95 <= second < 165)) for second in range(SECONDS)]
    assert score(truth(), told, timetable).wrong_way_reports == 4


def test_a_truth_without_trips_is_one_clear_error(tmp_path: Path) -> None:
    (tmp_path / "drive.toml").write_text(
        '[drive]\nvehicle_id = "bus"\n\n[[nmea]]\npath = "gps.nmea"\n\n'
        '[truth]\npath = "truth.csv"\n'
    )
    (tmp_path / "gps.nmea").write_text("")
    (tmp_path / "truth.csv").write_text("t_s,lat_deg,lon_deg\n0,1,1\n1,1,1\n")
    with pytest.raises(InputError, match="no column trip_id"):
        read_trip_truth(tmp_path)
