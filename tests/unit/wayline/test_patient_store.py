"""A store whose database goes away: nobody waits, nothing is lost, and it says so."""

import logging
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import msgspec
import pytest
import sqlalchemy as sa

from postgres import Cluster
from wayline.core import Record
from wayline.database import write_transaction
from wayline.errors import InputError
from wayline.patient_store import PatientStore, Tables
from wayline.settings import Settings

WAIT_S = 10.0
SETTINGS = Settings(database_retry_s=0.1, database_refresh_s=0.1)
PACKAGE = "wayline_slope_map"
"""Whose migrations make a table to write to."""


class Road(Record, frozen=True):
    """A row; `bin_m` that is None is refused by the database."""

    name: str
    bin_m: float | None = 20.0


class News(msgspec.Struct, frozen=True):
    names: tuple[str, ...]


class Roads:
    """Writes roads, and tells of all when there are more."""

    def __init__(self, engine: sa.Engine) -> None:
        self._engine = engine
        self._told: tuple[str, ...] = ()

    def save(self, vehicle_id: str, record: Record) -> Sequence[msgspec.Struct]:
        assert isinstance(record, Road)
        statement = sa.text("INSERT INTO slope_road VALUES (:name, :bin_m, FALSE, FALSE, '[]')")
        with write_transaction(self._engine) as connection:
            connection.execute(statement, {"name": record.name, "bin_m": record.bin_m})
        return ()

    def names(self) -> tuple[str, ...]:
        with self._engine.connect() as connection:
            rows = connection.exec_driver_sql("SELECT road_id FROM slope_road ORDER BY road_id")
            return tuple(row[0] for row in rows)

    def look(self) -> Sequence[msgspec.Struct]:
        there = self.names()
        if there == self._told:
            return ()
        self._told = there
        return (News(there),)


class Running:
    """A store at work, and what it told."""

    def __init__(self, url: str, **options: Any) -> None:
        self.told: list[msgspec.Struct] = []
        self.failed = threading.Event()
        self.store = PatientStore(
            Tables(url, PACKAGE, Roads), SETTINGS, self.told.append, **options
        )
        self.store.start(self.failed.set)

    def put(self, *names: str) -> None:
        for name in names:
            self.store.of("bus-1").save(Road(name=name))

    def await_that(self, holds: Callable[[], bool]) -> None:
        deadline_s, pause = time.monotonic() + WAIT_S, threading.Event()
        while not holds():
            assert time.monotonic() < deadline_s, (self.store.problem, self.told)
            self.store.hand_over()
            pause.wait(0.01)

    def await_told(self, *names: str) -> None:
        self.await_that(lambda: News(names) in self.told)


@pytest.fixture
def run() -> Iterator[Callable[..., Running]]:
    started: list[Running] = []

    def start(url: str, **options: bool) -> Running:
        started.append(Running(url, **options))
        return started[-1]

    yield start
    for running in started:
        running.store.close()


def names_in(url: str) -> tuple[str, ...]:
    engine = sa.create_engine(url.replace("postgresql:", "postgresql+psycopg:"))
    names = Roads(engine).names()
    engine.dispose()
    return names


def test_records_are_kept_in_order_and_told(run: Callable[..., Running], database_url: str) -> None:
    running = run(database_url)
    running.put("a", "b", "c")
    running.await_told("a", "b", "c")
    assert running.store.problem is None
    assert running.store.detail is None


def test_the_end_keeps_what_was_just_handed_over(database_url: str) -> None:
    running = Running(database_url)
    running.put(*"abcdefgh")
    running.store.close()
    assert names_in(database_url) == tuple("abcdefgh")


def test_a_folder_that_is_mounted_later_gets_what_waited(
    run: Callable[..., Running], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = tmp_path / "disk"
    caplog.set_level(logging.INFO, "wayline")
    running = run(f"sqlite:///{folder}/a.db")
    running.put("a", "b")
    said = running.store.problem
    assert said == f"away (no folder {folder}), 2 records wait"
    assert running.store.detail == f"database {said}"
    assert running.store.ask(lambda roads: roads.names()) is None
    folder.mkdir()
    running.await_told("a", "b")
    running.await_that(lambda: running.store.problem is None)
    assert [record.getMessage().split(":")[0] for record in caplog.records] == [
        "the database cannot be used",
        "the database is used again",
    ]


def test_a_table_that_goes_and_comes_back_costs_nothing(
    run: Callable[..., Running], database_url: str
) -> None:
    running = run(database_url)
    running.put("a")
    running.await_told("a")
    engine = sa.create_engine(database_url.replace("postgresql:", "postgresql+psycopg:"))
    with engine.begin() as connection:
        connection.exec_driver_sql("ALTER TABLE slope_road RENAME TO gone")
    running.put("b")
    running.await_that(lambda: "1 records wait" in (running.store.problem or ""))
    with engine.begin() as connection:
        connection.exec_driver_sql("ALTER TABLE gone RENAME TO slope_road")
    engine.dispose()
    running.await_told("a", "b")


def test_a_record_that_the_database_refuses_holds_up_no_other(
    run: Callable[..., Running], database_url: str
) -> None:
    running = run(database_url)
    running.store.of("bus-1").save(Road(name="x", bin_m=None))
    running.put("a")
    running.await_told("a")
    assert running.store.problem is None
    assert (running.store.detail or "").startswith("1 records lost")


def test_what_another_process_writes_is_told(
    run: Callable[..., Running], database_url: str
) -> None:
    running, other = run(database_url), run(database_url)
    other.put("theirs")
    running.await_told("theirs")


def test_questions_are_answered_as_of_now(run: Callable[..., Running], database_url: str) -> None:
    running = run(database_url)
    assert running.store.ask(lambda roads: roads.names()) == ()
    running.put("a")
    assert running.store.ask(lambda roads: roads.names()) in ((), ("a",))
    running.await_told("a")
    assert running.store.ask(lambda roads: roads.names()) == ("a",)


def test_what_only_editing_mends_is_said_at_once(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not a database address"):
        Running("nonsense")


def test_a_database_that_a_newer_version_wrote_meanwhile_ends_the_store(tmp_path: Path) -> None:
    folder = tmp_path / "disk"
    running = Running(f"sqlite:///{folder}/a.db")
    newer = tmp_path / "newer"
    newer.mkdir()
    engine = sa.create_engine(f"sqlite:///{newer}/a.db")
    with engine.begin() as connection:
        table = "alembic_version_slope_map"
        connection.exec_driver_sql(f"CREATE TABLE {table} (version_num TEXT)")
        connection.exec_driver_sql(f"INSERT INTO {table} VALUES ('9999')")
    engine.dispose()
    newer.rename(folder)
    assert running.failed.wait(WAIT_S)
    with pytest.raises(InputError, match="newer version"):
        running.store.close()


def test_a_server_that_stops_and_returns_gets_everything(
    run: Callable[..., Running], postgres: Cluster
) -> None:
    url = postgres.new_url()
    running = run(url)
    running.put("a")
    running.await_told("a")
    postgres.stop("immediate")
    running.put("b", "c")
    running.await_that(lambda: "2 records wait" in (running.store.problem or ""))
    postgres.start()
    running.await_told("a", "b", "c")
    running.await_that(lambda: running.store.problem is None)


def test_a_frozen_server_makes_nobody_wait(
    run: Callable[..., Running], postgres: Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wayline.patient_store.SLOW_S", 0.3)
    running = run(postgres.new_url())
    running.put("a")
    running.await_told("a")
    postgres.freeze()
    try:
        started_s = time.monotonic()
        running.put("b")
        assert time.monotonic() - started_s < 0.1
        running.await_that(lambda: "silent" in (running.store.problem or ""))
        assert running.store.ask(lambda roads: roads.names()) is None
    finally:
        postgres.thaw()
    running.await_told("a", "b")
