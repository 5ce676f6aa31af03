"""The database layer: what was acknowledged is kept, and what cannot be used is said plainly."""

import os
import re
import signal
import sqlite3
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
import sqlalchemy as sa

from postgres import Cluster
from wayline.database import DatabaseAwayError, open_database, write_transaction
from wayline.errors import InputError
from wayline_slope_map.tables import METADATA

PACKAGE = "wayline_slope_map"
ROAD = "INSERT INTO slope_road VALUES ('{}', 20.0, 0, 0, '[]')"


def test_a_new_file_gets_the_tables_and_its_own_version_table(tmp_path: Path) -> None:
    engine = open_database(f"sqlite:///{tmp_path}/a.db", PACKAGE)
    names = sa.inspect(engine).get_table_names()
    engine.dispose()
    assert {"slope_road", "slope_bin_sum", "slope_ledger"} < set(names)
    assert "alembic_version_slope_map" in names


def test_tables_are_those_that_the_store_uses(tmp_path: Path) -> None:
    engine = open_database(f"sqlite:///{tmp_path}/a.db", PACKAGE)
    inspector = sa.inspect(engine)
    for table in METADATA.sorted_tables:
        columns = inspector.get_columns(table.name)
        there = {column["name"]: str(column["type"]) for column in columns}
        assert there == {column.name: str(column.type) for column in table.columns}
        keys = inspector.get_pk_constraint(table.name)["constrained_columns"]
        assert keys == [column.name for column in table.primary_key.columns]
    engine.dispose()


def test_sqlite_is_durable_and_readable_while_written(tmp_path: Path) -> None:
    engine = open_database(f"sqlite:///{tmp_path}/a.db", PACKAGE)
    with engine.connect() as connection:
        read = {
            name: connection.exec_driver_sql(f"PRAGMA {name}").scalar()
            for name in ("journal_mode", "synchronous", "foreign_keys", "busy_timeout")
        }
    with write_transaction(engine) as writer, engine.connect() as reader:
        writer.exec_driver_sql(ROAD.format("x"))
        assert reader.exec_driver_sql("SELECT count(*) FROM slope_road").scalar() == 0
    engine.dispose()
    assert read == {
        "journal_mode": "wal",
        "synchronous": 2,
        "foreign_keys": 1,
        "busy_timeout": 5000,
    }


def test_a_failed_transaction_leaves_nothing(tmp_path: Path) -> None:
    engine = open_database(f"sqlite:///{tmp_path}/a.db", PACKAGE)

    def add_the_same_twice() -> None:
        with write_transaction(engine) as connection:
            connection.exec_driver_sql(ROAD.format("x"))
            connection.exec_driver_sql(ROAD.format("x"))

    with pytest.raises(sa.exc.IntegrityError):
        add_the_same_twice()
    with engine.connect() as connection:
        assert connection.exec_driver_sql("SELECT count(*) FROM slope_road").scalar() == 0
    engine.dispose()


def test_what_was_committed_survives_kill(tmp_path: Path) -> None:
    program = (
        "import sys; from wayline.database import open_database, write_transaction\n"
        f"engine = open_database('sqlite:///{tmp_path}/a.db', '{PACKAGE}')\n"
        "for i in range(1000000):\n"
        "    with write_transaction(engine) as connection:\n"
        f'        connection.exec_driver_sql("{ROAD.format("r%d")}" % i)\n'
        "    print(i, flush=True)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True
    ) as child:
        assert child.stdout is not None
        acknowledged = [int(child.stdout.readline()) for _ in range(20)][-1]
        os.kill(child.pid, signal.SIGKILL)
        rest = child.stdout.read().split()
    acknowledged = int(rest[-1]) if rest else acknowledged
    engine = open_database(f"sqlite:///{tmp_path}/a.db", PACKAGE)
    with engine.connect() as connection:
        kept = connection.exec_driver_sql("SELECT count(*) FROM slope_road").scalar()
        assert connection.exec_driver_sql("PRAGMA integrity_check").scalar() == "ok"
    engine.dispose()
    assert kept in (acknowledged + 1, acknowledged + 2)


def test_a_database_in_memory_lives_as_long_as_its_engine() -> None:
    engine = open_database("sqlite://", PACKAGE)
    with write_transaction(engine) as connection:
        connection.exec_driver_sql(ROAD.format("x"))
    with engine.connect() as connection:
        assert connection.exec_driver_sql("SELECT count(*) FROM slope_road").scalar() == 1
    engine.dispose()


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("slope.db", "write sqlite:///slope.db"),
        ("/var/lib/slope.db", "write sqlite:////var/lib/slope.db"),
        ("mysql://localhost/slope", "use sqlite:///FILE"),
        ("sqlite+none:///slope.db", "driver is not installed"),
        ("sqlite:////nowhere/at/all/slope.db", "no folder /nowhere/at/all"),
    ],
)
def test_an_address_that_cannot_be_used_says_how_to_mend_it(url: str, said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        open_database(url, PACKAGE)


def test_a_reader_creates_no_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file"):
        open_database(f"sqlite:///{tmp_path}/typo.db", PACKAGE, create=False)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_no_database_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("not a database, " * 100)
    with pytest.raises(InputError, match="cannot be opened"):
        open_database(f"sqlite:///{tmp_path}/notes.txt", PACKAGE)


def test_a_database_from_a_newer_version_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.db"
    open_database(f"sqlite:///{path}", PACKAGE).dispose()
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE alembic_version_slope_map SET version_num = 'slope_9999'")
    connection.close()
    with pytest.raises(InputError, match=r"newer version .*slope_9999.*update Wayline"):
        open_database(f"sqlite:///{path}", PACKAGE)


ADDRESSES_WITH_A_SECRET = [
    "mysql://me:secret@localhost/slope",
    "postgresql://me:secret@localhost:54x2/slope",
    "postgresql://me:secret@localhost:99999/slope",
    "postgresql://me:not@secret@localhost/slope",
    "postgresql://me:not@a/secret@localhost/slope",
    "postgresql://me:secret",
    "postgresql://localhost/slope?password=secret&nonsense=1",
    "postgresql://me:secret@127.0.0.1:1/slope",
    "postgresql+nonsense://me:secret@localhost/slope",
    "postgres//me:secret@localhost/slope",
    "host=localhost user=me password=secret",
    "me:secret",
]


@pytest.mark.parametrize("url", ADDRESSES_WITH_A_SECRET)
def test_a_password_is_never_shown(url: str) -> None:
    with pytest.raises(InputError) as caught:
        open_database(url, PACKAGE)
    assert "secret" not in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("postgresql://me@localhost:54x2/slope", "has a port that is no number"),
        ("postgresql://me@localhost:99999/slope", "has port 99999"),
        ("postgresql://me:a@b@localhost/slope", "has more than one @"),
        ("postgresql://localhost/slope?nonsense=1", "nonsense"),
    ],
)
def test_what_only_editing_mends_is_not_called_away(url: str, said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)) as caught:
        open_database(url, PACKAGE)
    assert not isinstance(caught.value, DatabaseAwayError)


def test_a_server_or_a_folder_that_is_not_there_is_away(tmp_path: Path) -> None:
    for url in (
        "postgresql://127.0.0.1:1/slope",
        f"sqlite:///{tmp_path}/not-mounted/a.db",
    ):
        with pytest.raises(DatabaseAwayError):
            open_database(url, PACKAGE)


def test_two_services_make_their_tables_at_once(postgres: Cluster) -> None:
    """Each process sees an empty database first; the second waits for the first one's tables."""
    url = postgres.new_url()
    packages = ["wayline_slope_map", "wayline_fusion"] * 2
    at_once = threading.Barrier(len(packages))

    def start(package: str) -> set[str]:
        at_once.wait(10.0)
        engine = open_database(url, package)
        names = set(sa.inspect(engine).get_table_names())
        engine.dispose()
        return names

    with ThreadPoolExecutor(len(packages)) as pool:
        found = list(pool.map(start, packages))
    assert all("slope_ledger" in names for names in found[::2])
    assert all("fusion_vehicle" in names for names in found[1::2])
