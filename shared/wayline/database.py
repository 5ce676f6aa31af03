"""Opens a service's database and brings its tables up to date.

SQLite (one file a service; in replay one file for all) or PostgreSQL, by URL. Each service keeps
its migrations in `<package>/migrations/versions` and its own version table, so that services can
share a file and still be updated one by one.
"""

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import sqlalchemy as sa
from alembic import command, context
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy.pool import StaticPool

from wayline.database_address import is_sqlite, parsed_address, shown
from wayline.errors import InputError

BUSY_TIMEOUT_MS = 5_000
LOCK_TIMEOUT = "10s"
"""Another process that was frozen in the middle of a write holds its locks as long."""
SERVER_OPTIONS = {
    "application_name": "wayline",
    "connect_timeout": 3,
    # a server whose machine is gone says nothing: give up on it within ten seconds
    "keepalives_idle": 5,
    "keepalives_interval": 2,
    "keepalives_count": 3,
    "tcp_user_timeout": 10_000,
}
MIGRATION_LOCK = 0x7761796C696E65
"""Of every service alike; "wayline" in ASCII."""
WRITES = "wayline_writes"


class DatabaseAwayError(InputError):
    """A database that cannot be used now and may be later: its server or its disk is away.

    A command ends with it; a service goes on and tries again.
    """


def open_database(url: str, service_package: str, *, create: bool = True) -> sa.Engine:
    """An engine on the database at `url` with the tables of `service_package` up to date.

    The package holds `migrations/env.py` (two lines, see `run_migrations`) and
    `migrations/versions/*.py`. Raises DatabaseAwayError where it may be there later, else
    InputError: an address that is none, a database that a newer version has written. Without
    `create` a SQLite file that is not there yet is an InputError too.
    """
    address = parsed_address(url)
    if not create and _is_missing(address):
        raise InputError(url, f"no file {address.database}", "correct the address")
    engine = _engine_on(address)
    try:
        _migrate(engine, service_package)
    except sa.exc.DBAPIError as error:
        engine.dispose()
        raise _unusable(address, error) from None
    except InputError:
        engine.dispose()
        raise
    return engine


@contextmanager
def write_transaction(engine: sa.Engine) -> Iterator[sa.Connection]:
    """A transaction that reads and then writes; when it has ended without error, it is on disk.

    On SQLite it takes the write lock at once, because a lock that is only asked for after a read
    fails when another process wrote in between.
    """
    with engine.execution_options(**{WRITES: True}).begin() as connection:
        if not is_sqlite(engine.url):
            connection.exec_driver_sql(f"SET LOCAL lock_timeout = '{LOCK_TIMEOUT}'")
        yield connection


def run_migrations() -> None:
    """What every service's `migrations/env.py` calls: upgrade over the connection given to it."""
    attributes = context.config.attributes
    context.configure(
        connection=attributes["connection"],
        version_table=attributes["version_table"],
        # Alembic assumes the driver's autocommit before DDL; `_make_sqlite_safe` turns it off
        transactional_ddl=True,
    )
    with context.begin_transaction():
        context.run_migrations()


def said(error: sa.exc.DBAPIError) -> str:
    """The driver's own words, in one line; what follows them are guesses."""
    return str(error.orig).strip().partition("\n")[0]


def _is_missing(address: sa.URL) -> bool:
    return bool(is_sqlite(address) and address.database and not Path(address.database).is_file())


def _engine_on(address: sa.URL) -> sa.Engine:
    try:
        engine = sa.create_engine(address, **_engine_options(address))
    except (ImportError, sa.exc.NoSuchModuleError) as error:
        what = f"its database driver is not installed ({error})"
        raise InputError(shown(address), what, 'pip install "wayline[postgres]"') from None
    if is_sqlite(address):
        _make_sqlite_safe(engine)
    return engine


def _engine_options(address: sa.URL) -> dict[str, Any]:
    if not is_sqlite(address):
        given = {name: value for name, value in SERVER_OPTIONS.items() if name not in address.query}
        return {"connect_args": given}
    if address.database:
        folder = Path(address.database).parent
        if not folder.is_dir():
            mend = "create it, mount its disk or correct the address"
            raise DatabaseAwayError(shown(address), f"no folder {folder}", mend)
        return {}
    # in memory there is one, whichever thread asks
    return {"poolclass": StaticPool, "connect_args": {"check_same_thread": False}}


def _unusable(address: sa.URL, error: sa.exc.DBAPIError) -> InputError:
    """An option of the address that the driver does not know will be unknown for ever."""
    what, mend = f"cannot be opened ({said(error)})", "check the address and its rights"
    is_of_server = getattr(error.orig, "sqlstate", None) is not None
    if isinstance(error, sa.exc.ProgrammingError) and not is_of_server:
        return InputError(shown(address), what, mend)
    return DatabaseAwayError(shown(address), what, mend)


def _make_sqlite_safe(engine: sa.Engine) -> None:
    """Durable at commit, readable while it is written, and in charge of its own transactions."""

    @sa.event.listens_for(engine, "connect")
    def configure(connection, _record) -> None:  # type: ignore[no-untyped-def]  # DBAPI's own
        connection.isolation_level = None  # else the driver begins only before the first write
        for pragma in (
            f"busy_timeout={BUSY_TIMEOUT_MS}",
            "journal_mode=WAL",
            "synchronous=FULL",
            "foreign_keys=ON",
        ):
            connection.execute(f"PRAGMA {pragma}")

    @sa.event.listens_for(engine, "begin")
    def begin(connection: sa.Connection) -> None:
        writes = connection.get_execution_options().get(WRITES, False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")


def _migrate(engine: sa.Engine, service_package: str) -> None:
    config = Config()
    folder = Path(str(importlib.import_module(service_package).__file__)).parent / "migrations"
    config.set_main_option("script_location", str(folder).replace("%", "%%"))
    config.set_main_option("path_separator", "os")
    table = "alembic_version_" + service_package.rpartition(".")[2].removeprefix("wayline_")
    scripts = ScriptDirectory.from_config(config)
    with engine.connect() as connection:
        there = MigrationContext.configure(connection, opts={"version_table": table})
        current = there.get_current_revision()
    if current == scripts.get_current_head():
        return
    known = {script.revision for script in scripts.walk_revisions()}
    if current is not None and current not in known:
        raise InputError(
            shown(engine.url),
            f"was written by a newer version ({service_package} {current})",
            "update Wayline or name another database",
        )
    with write_transaction(engine) as connection:
        if not is_sqlite(engine.url):
            # a second process waits here, then finds the tables made
            connection.execute(sa.select(sa.func.pg_advisory_xact_lock(MIGRATION_LOCK)))
        config.attributes.update(connection=connection, version_table=table)
        command.upgrade(config, "head")
