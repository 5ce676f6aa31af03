"""The store: each run once, in any order, durably, in a space that does not grow with the runs."""

import itertools
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import msgspec
import pytest
import sqlalchemy as sa

from wayline.core import Record
from wayline.database import open_database
from wayline_slope_map.export import ExportRow, export_rows
from wayline_slope_map.records import FinishedRun, RunBin
from wayline_slope_map.roads import Road
from wayline_slope_map.store import SlopeStore, SlopeTables

PACKAGE = "wayline_slope_map"
HOUR_NS = 3600 * 1_000_000_000
START_NS = 1_700_000_000_000_000_000
POINTS = ((56.0, 10.0), (56.0, 10.005), (56.002, 10.008))
ROAD = Road("road-a", 20.0, loop=False, is_route=False, points=POINTS)


def run(
    k: int, *, vehicle_id: str = "car", road: Road = ROAD, start_ns: int | None = None
) -> FinishedRun:
    start_ns = START_NS + k * HOUR_NS if start_ns is None else start_ns
    bins = tuple(
        RunBin(i, "fused", 2.0 + 0.137 * k - i / 7, 0.4 + 0.03 * k, 100.0 + i / 3 + k, 3.0 + k / 9)
        for i in range(15)
    )
    return FinishedRun(
        vehicle_id=vehicle_id,
        road=road,
        direction=1,
        start_ns=start_ns,
        end_ns=start_ns + HOUR_NS // 2,
        bins=bins,
    )


@pytest.fixture
def engine(database_url: str) -> Iterator[sa.Engine]:
    opened = open_database(database_url, PACKAGE)
    yield opened
    opened.dispose()


def counts(engine: sa.Engine) -> dict[str, int]:
    with engine.connect() as connection:
        return {
            table: connection.exec_driver_sql(f"SELECT count(*) FROM {table}").scalar_one()
            for table in ("slope_road", "slope_bin_sum", "slope_ledger")
        }


def content(engine: sa.Engine) -> list[tuple[object, ...]]:
    with engine.connect() as connection:
        rows = connection.exec_driver_sql("SELECT * FROM slope_bin_sum ORDER BY bin_index")
        return [tuple(row) for row in rows]


def test_merging_in_any_order_gives_the_same_database_to_the_last_digit(
    new_url: Callable[[], str],
) -> None:
    contents = set()
    for order in itertools.permutations([run(k) for k in range(4)]):
        opened = open_database(new_url(), PACKAGE)
        for record in order:
            SlopeStore(opened).save(record)
        contents.add(tuple(content(opened)))
        opened.dispose()
    assert len(contents) == 1


def test_a_merge_is_answered_with_the_road_as_it_now_is(engine: sa.Engine) -> None:
    store = SlopeStore(engine)
    store.save(run(0))
    (answer,) = store.save(run(1))
    assert answer.profile.road == ROAD
    assert {known.runs for known in answer.profile.bins[1].values()} == {2}
    assert [answer.profile] == store.load_roads()


def test_a_run_merged_twice_counts_once(engine: sa.Engine) -> None:
    store = SlopeStore(engine)
    store.save(run(0))
    before = content(engine)
    assert store.save(run(0)) == []
    assert content(engine) == before


@pytest.mark.parametrize(
    ("shift_ns", "counted"),
    [(HOUR_NS // 4, 1), (-HOUR_NS // 4, 1), (HOUR_NS // 2, 2), (-HOUR_NS // 2, 2)],
)
def test_of_runs_that_overlap_in_time_the_first_stands(
    engine: sa.Engine, shift_ns: int, counted: int
) -> None:
    store = SlopeStore(engine)
    store.save(run(0))
    store.save(run(1, start_ns=START_NS + shift_ns))
    (profile,) = store.load_roads()
    assert profile.bins[1][3].runs == counted


def test_another_vehicle_or_direction_at_the_same_time_is_another_run(engine: sa.Engine) -> None:
    store = SlopeStore(engine)
    store.save(run(0))
    store.save(run(0, vehicle_id="bus"))
    store.save(msgspec.structs.replace(run(0), direction=-1))
    (profile,) = store.load_roads()
    assert (profile.bins[1][3].runs, profile.bins[-1][3].runs) == (2, 1)


def test_a_drive_already_counted_makes_no_new_road(engine: sa.Engine) -> None:
    store = SlopeStore(engine)
    store.save(run(0))
    other = Road("road-b", 20.0, loop=False, is_route=False, points=POINTS[:2])
    assert store.save(run(0, road=other)) == []
    assert len(store.save(run(1, road=other))) == 1
    assert [profile.road.road_id for profile in store.load_roads()] == ["road-a", "road-b"]


def test_space_does_not_grow_with_the_runs_but_for_the_ledger(engine: sa.Engine) -> None:
    store = SlopeStore(engine)
    store.save(run(0))
    before = counts(engine)
    for k in range(1, 12):
        store.save(run(k))
    assert counts(engine) == {**before, "slope_ledger": 12}


def test_two_writers_at_once_count_every_run_once(database_url: str) -> None:
    engines = [open_database(database_url, PACKAGE) for _ in range(2)]
    with ThreadPoolExecutor(2) as pool:
        saved = [
            pool.submit(SlopeStore(engine).save, run(k)) for k in range(30) for engine in engines
        ]
        answers = [future.result() for future in saved]
    assert sum(len(answer) for answer in answers) == 30
    assert counts(engines[0])["slope_ledger"] == 30
    for engine in engines:
        engine.dispose()


def test_only_finished_runs_are_kept(engine: sa.Engine) -> None:
    with pytest.raises(TypeError):
        SlopeStore(engine).save(Record())


def test_what_was_acknowledged_survives_kill(database_url: str) -> None:
    program = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from unit.slope_map.test_store import SlopeStore, open_database, run, PACKAGE\n"
        "store = SlopeStore(open_database(sys.argv[2], PACKAGE))\n"
        "for k in range(1000000):\n"
        "    store.save(run(k))\n"
        "    print(k, flush=True)\n"
    )
    tests = str(Path(__file__).parents[2])
    with subprocess.Popen(
        [sys.executable, "-c", program, tests, database_url], stdout=subprocess.PIPE, text=True
    ) as child:
        assert child.stdout is not None
        said = [child.stdout.readline() for _ in range(10)]
        os.kill(child.pid, signal.SIGKILL)
        said += child.stdout.read().splitlines()
    opened = open_database(database_url, PACKAGE)
    # a server may still be at the last one: the lock of another write waits for it
    SlopeStore(opened).save(run(0))
    acknowledged = len([line for line in said if line.strip()])
    (profile,) = SlopeStore(opened).load_roads()
    kept = {known.runs for known in profile.bins[1].values()}
    ledger = counts(opened)["slope_ledger"]
    opened.dispose()
    assert kept == {ledger}
    assert ledger in (acknowledged, acknowledged + 1)


def test_export_names_each_bin_by_its_centre_in_the_direction_of_travel(engine: sa.Engine) -> None:
    store = SlopeStore(engine)
    store.save(run(0))
    store.save(msgspec.structs.replace(run(0), direction=-1))
    rows = list(export_rows(engine))
    assert len(rows) == 30
    assert rows[0].lon_deg == pytest.approx(10.00016, abs=1e-6)
    assert rows[0].heading_deg == pytest.approx(90.0, abs=0.01)
    assert rows[0] == ExportRow(
        road_id="road-a",
        distance_m=10.0,
        lat_deg=56.0,
        lon_deg=rows[0].lon_deg,
        heading_deg=rows[0].heading_deg,
        grade_pct=2.0,
        grade_std_pct=0.4,
        alt_m=100.0,
        runs=1,
        updated="2023-11-14T22:43:20.000Z",
        flagged_runs=0,
    )
    assert rows[15].heading_deg == pytest.approx(270.0, abs=0.01)
    assert [row.distance_m for row in rows[:15]] == [10.0 + 20.0 * i for i in range(15)]


def test_what_others_wrote_is_told_at_the_next_look(database_url: str) -> None:
    here, there = (open_database(database_url, PACKAGE) for _ in range(2))
    tables = SlopeTables(here)
    assert list(tables.look()) == []
    SlopeStore(there).save(run(0))
    (learned,) = tables.look()
    assert [learned.profile] == SlopeStore(there).load_roads()
    assert list(tables.look()) == []
    SlopeStore(there).save(run(1))
    assert [each.profile.bins[1][3].runs for each in tables.look()] == [2]
    for engine in (here, there):
        engine.dispose()


def test_tables_tell_of_their_own_runs_once(engine: sa.Engine) -> None:
    tables = SlopeTables(engine)
    assert list(tables.save("car", run(0))) == []
    assert [each.profile.road for each in tables.look()] == [ROAD]
    assert list(tables.look()) == []
