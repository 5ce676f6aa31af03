"""Runs kept beside the sums: judged when read, in any order, and taken out again."""

import itertools
import math
from collections.abc import Iterator

import pytest
import sqlalchemy as sa

from wayline.database import open_database
from wayline.errors import InputError
from wayline_slope_map.kept_run import kept, rounded
from wayline_slope_map.ledger import listed_runs, run_name
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import FinishedRun, RunBin
from wayline_slope_map.roads import Road
from wayline_slope_map.store import SlopeStore
from wayline_slope_map.withdrawal import withdraw

PACKAGE = "wayline_slope_map"
VERSIONS = "alembic_version_slope_map"
DAY_NS = 86_400_000_000_000
START_NS = 1_700_000_000_000_000_000
KM_BINS = 50
ROAD = Road("road-a", 20.0, False, False, ((56.0, 10.0), (56.0, 10.16)))
BINS = range(10, 460)


def true_pct(index: int) -> float:
    return 3.0 * math.sin(index / 12.0)


def run(day: int, *, off_pct: float = 0.0, bad: range = range(0)) -> FinishedRun:
    """A run over 9 km that errs by 0.1 % or so, and in some bins by much more."""
    bins = []
    for i in BINS:
        error_pct = 0.1 * math.sin(i / (7.0 + day)) + (off_pct if i in bad else 0.0)
        alt_m = 100.0 - 0.2 * 12.0 * 3.0 * math.cos(i / 12.0)
        bins.append(RunBin(i, "fused", true_pct(i) + error_pct, 0.3, alt_m, 2.0))
        bins.append(RunBin(i, "gps", true_pct(i) + 2.0 * error_pct, 0.6, alt_m, 3.0))
        bins.append(RunBin(i, "barometer", true_pct(i) - error_pct, 0.5, alt_m, 4.0))
        bins.append(RunBin(i, "torque", true_pct(i) + error_pct, 0.4, 0.0, 100.0))
    start_ns = START_NS + day * DAY_NS
    return FinishedRun(
        vehicle_id="car",
        road=ROAD,
        direction=1,
        start_ns=start_ns,
        end_ns=start_ns + 600_000_000_000,
        bins=tuple(bins),
    )


def bad_run(day: int) -> FinishedRun:
    return run(day, off_pct=5.0, bad=range(200, 230))


def known(engine: sa.Engine) -> RoadProfile:
    (profile,) = SlopeStore(engine).load_roads()
    return profile


@pytest.fixture
def engine(database_url: str) -> Iterator[sa.Engine]:
    opened = open_database(database_url, PACKAGE)
    yield opened
    opened.dispose()


def test_a_kept_run_takes_at_most_400_bytes_a_km() -> None:
    assert len(kept(run(1).bins)) / (len(BINS) / KM_BINS) <= 400.0


def test_a_kept_run_comes_back_rounded_and_then_stays_as_it_is() -> None:
    once = rounded(run(1).bins)
    assert rounded(once) == once
    by_place = {(each.sensor, each.bin_index): each for each in once}
    for each in run(1).bins:
        back = by_place[each.sensor, each.bin_index]
        assert back.grade_pct == pytest.approx(each.grade_pct, abs=0.0026)
        assert back.grade_std_pct == pytest.approx(each.grade_std_pct, rel=0.001)
        has_alt = each.sensor == "fused"
        assert back.alt_m == (pytest.approx(each.alt_m, abs=0.026) if has_alt else None)


def test_one_bad_run_of_three_is_flagged_and_does_not_move_the_map(engine: sa.Engine) -> None:
    for each in (run(0), bad_run(1), run(2)):
        SlopeStore(engine).save(each)
    bins = known(engine).bins[1]
    assert max(abs(bins[i].grade_pct - true_pct(i)) for i in BINS) < 0.2
    assert {i for i in BINS if bins[i].flagged_runs} == set(range(200, 230))
    assert {bins[i].runs for i in range(200, 230)} == {2}


def test_of_two_runs_nobody_knows_which_is_bad(engine: sa.Engine) -> None:
    for each in (run(0), bad_run(1)):
        SlopeStore(engine).save(each)
    bins = known(engine).bins[1]
    assert not any(bins[i].flagged_runs for i in BINS)
    assert bins[215].grade_std_pct > 1.0


def test_any_order_of_runs_gives_the_same_map_to_the_last_digit(tmp_path: object) -> None:
    profiles = []
    for number, order in enumerate(itertools.permutations((run(0), bad_run(1), run(2)))):
        engine = open_database(f"sqlite:///{tmp_path}/{number}.db", PACKAGE)
        for each in order:
            SlopeStore(engine).save(each)
        profiles.append(known(engine))
        engine.dispose()
    assert all(profile == profiles[0] for profile in profiles)


def test_a_withdrawn_run_leaves_the_map_as_it_was_and_does_not_come_back(engine: sa.Engine) -> None:
    store = SlopeStore(engine)
    for each in (run(0), run(1)):
        store.save(each)
    before = sums(engine)
    counts = store.run_counts()
    store.save(bad_run(2))
    name = run_name("car", "road-a", 1, START_NS + 2 * DAY_NS)
    assert withdraw(engine, name).run == name
    assert sums(engine) == before
    assert store.run_counts() == counts
    store.save(bad_run(2))
    assert sums(engine) == before
    assert [each.state for each in listed_runs(engine)] == ["merged", "merged", "withdrawn"]


def test_the_only_run_of_a_road_can_be_withdrawn(engine: sa.Engine) -> None:
    SlopeStore(engine).save(run(0))
    withdraw(engine, listed_runs(engine)[0].run)
    assert not known(engine).bins


def test_what_cannot_be_withdrawn_is_one_clear_line(engine: sa.Engine) -> None:
    SlopeStore(engine).save(run(0))
    with pytest.raises(InputError, match="no run of this database"):
        withdraw(engine, "0123456789")
    name = listed_runs(engine)[0].run
    withdraw(engine, name)
    with pytest.raises(InputError, match="already"):
        withdraw(engine, name)


def test_runs_that_agree_more_than_they_claim_have_much_in_common(engine: sa.Engine) -> None:
    """They differ by 0.1 % and claim 0.3 %: more of them do not make that much surer."""
    for day in range(6):
        SlopeStore(engine).save(run(day))
    stds_pct = [each.grade_std_pct for each in known(engine).bins[1].values()]
    assert max(stds_pct) < 0.3
    assert min(stds_pct) > 0.25


def test_a_database_of_before_keeps_its_sums_and_takes_new_runs(database_url: str) -> None:
    """Runs that were merged before runs were kept count on, but cannot be withdrawn."""
    engine = open_database(database_url, PACKAGE)
    SlopeStore(engine).save(run(0))
    grades_pct = [each.grade_pct for each in known(engine).bins[1].values()]
    with engine.begin() as connection:
        for column in ("kept", "withdrawn"):
            connection.execute(sa.text(f"ALTER TABLE slope_ledger DROP COLUMN {column}"))
        connection.execute(sa.text("DROP TABLE slope_left_out"))
        connection.execute(sa.text(f"UPDATE {VERSIONS} SET version_num = 'slope_0001'"))
    engine.dispose()
    engine = open_database(database_url, PACKAGE)
    assert [each.grade_pct for each in known(engine).bins[1].values()] == grades_pct
    SlopeStore(engine).save(run(1))
    assert {each.runs for each in known(engine).bins[1].values()} == {2}
    old, new = listed_runs(engine)
    assert (old.state, new.state) == ("fixed", "merged")
    with pytest.raises(InputError, match="before runs were kept"):
        withdraw(engine, old.run)
    engine.dispose()


def sums(engine: sa.Engine) -> list[tuple[object, ...]]:
    """All but when a bin was last updated."""
    with engine.connect() as connection:
        rows = connection.execute(
            sa.text(
                "SELECT road_id, direction, bin_index, sensor, runs, grade_weight, grade_sum,"
                " grade_square_sum, alt_weight, alt_sum FROM slope_bin_sum"
                " ORDER BY road_id, direction, bin_index, sensor"
            )
        )
        return [tuple(row) for row in rows]
