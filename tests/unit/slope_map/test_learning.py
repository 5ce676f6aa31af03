"""Whole drives over a road of known grade: it is learned, and known as well as is claimed."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from unit.slope_map.hilly_road import (
    LAT_DEG,
    LON_DEG,
    SECOND_NS,
    START_NS,
    Floats,
    core,
    drive,
    runs_of,
    true_grade_pct,
)
from wayline.database import open_database
from wayline.geo import metres_per_degree
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.store import SlopeStore

DAY_NS = 86_400 * SECOND_NS


@pytest.fixture
def store(tmp_path: Path) -> Iterator[SlopeStore]:
    engine = open_database(f"sqlite:///{tmp_path}/slope.db", "wayline_slope_map")
    yield SlopeStore(engine)
    engine.dispose()


def drive_into(store: SlopeStore, day: int, *, barometer: bool) -> RoadProfile:
    """One more drive over the road; the road as it is known then."""
    known = core(profiles=store.load_roads())
    for record in runs_of(
        known, drive(seed=day, start_ns=START_NS + day * DAY_NS, barometer=barometer)
    ):
        store.save(record)
    (profile,) = store.load_roads()
    return profile


def errors_pct(profile: RoadProfile) -> tuple[Floats, Floats]:
    """Grade minus truth, and its claimed std, at the bins' own places."""
    known = profile.bins[1]
    centres = [profile.road.line.point_at(profile.road.centre_m(i)) for i in known]
    east_m = (np.array([at[1] for at in centres]) - LON_DEG) * metres_per_degree(LAT_DEG)[1]
    grade_pct = np.array([bin_.grade_pct for bin_ in known.values()])
    std_pct = np.array([bin_.grade_std_pct for bin_ in known.values()])
    return grade_pct - true_grade_pct(east_m), std_pct


@pytest.mark.parametrize(
    ("barometer", "first_pct", "sixth_pct"), [(True, 0.65, 0.40), (False, 1.7, 1.3)]
)
def test_the_grade_gets_better_with_runs_and_as_good_as_claimed(
    store: SlopeStore, barometer: bool, first_pct: float, sixth_pct: float
) -> None:
    """The truth waves by 3 % (rms 2.6 %); GPS altitude errs by 4 m that wander in 80 s."""
    profiles = [drive_into(store, day, barometer=barometer) for day in range(6)]
    rms_pct, claimed = [], []
    for profile in (profiles[0], profiles[-1]):
        error_pct, std_pct = errors_pct(profile)
        rms_pct.append(float(np.sqrt(np.mean(error_pct**2))))
        claimed.append(float(np.mean((error_pct / std_pct) ** 2)))
    assert rms_pct[0] < first_pct
    assert rms_pct[1] < min(sixth_pct, 0.85 * rms_pct[0])
    # normalised squared errors: 1 is exact, less is modest
    assert all(0.15 < ratio < 1.6 for ratio in claimed)
    assert {known.runs for known in profiles[-1].bins[1].values()} == {6}


def test_the_same_drive_twice_is_one_run_and_no_new_road(store: SlopeStore) -> None:
    once = drive_into(store, 0, barometer=True)
    assert drive_into(store, 0, barometer=True) == once


def test_a_drive_cut_shorter_or_started_later_is_still_the_same_run(store: SlopeStore) -> None:
    once = drive_into(store, 0, barometer=True)
    messages = drive(seed=0)
    for part in (messages[:3000], messages[1500:]):
        known = core(profiles=store.load_roads())
        records = runs_of(known, [*part, messages[-1]])
        assert records
        assert [store.save(record) for record in records] == [[]] * len(records)
    assert store.load_roads() == [once]
