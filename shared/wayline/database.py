"""Opens a service's database and brings its tables up to date.

SQLite (one file a service; in replay one file for all) or PostgreSQL, by URL. Each service keeps
its migrations in `<package>/migrations/versions` and its own version table, so that services can
share a file and still be updated one by one.
"""

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import sqlalchemy as sa
from alembic import command, context
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory

from wayline.errors import InputError

DIALECTS = ("sqlite", "postgresql")
BUSY_TIMEOUT_MS = 5_000
WRITES = "wayline_writes"


def open_database(url: str, service_package: str, *, create: bool = True) -> sa.Engine:
    """An engine on the database at `url` with the tables of `service_package` up to date.

    The package holds `migrations/env.py` (two lines, see `run_migrations`) and
    `migrations/versions/*.py`. Raises InputError for an address, a folder, a file or a server
    that cannot be used and for a database that a newer version has written. Without `create`
    a SQLite file that is not there yet is an InputError too.
    """
    address = _parsed(url)
    if not (create or _is_there(address)):
        raise InputError(url, f"no file {address.database}", "correct the address")
    engine = _engine_on(address)
    if address.get_backend_name() == "sqlite":
        _make_sqlite_safe(engine)
    try:
        _migrate(engine, service_package)
    except sa.exc.DBAPIError as error:
        engine.dispose()
        raise InputError(
            _shown(address), f"cannot be opened ({error.orig})", "check the address and its rights"
        ) from None
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


def _parsed(url: str) -> sa.URL:
    try:
        address = sa.make_url(url)
    except sa.exc.ArgumentError:
        mend = f"write sqlite:///{url} for a file or postgresql://user@host/name for a server"
        raise InputError(url, "is not a database address", mend) from None
    if address.get_backend_name() not in DIALECTS:
        mend = "use sqlite:///FILE or postgresql://user@host/name"
        raise InputError(_shown(address), "is a kind of database that is not known", mend)
    if address.get_backend_name() == "sqlite" and address.database:
        folder = Path(address.database).parent
        if not folder.is_dir():
            raise InputError(url, f"no folder {folder}", "create it or correct the address")
    return address


def _is_there(address: sa.URL) -> bool:
    in_file = address.get_backend_name() == "sqlite" and address.database
    return not in_file or Path(str(address.database)).is_file()


def _engine_on(address: sa.URL) -> sa.Engine:
    try:
        return sa.create_engine(address)
    except (ImportError, sa.exc.NoSuchModuleError) as error:
        what = f"its database driver is not installed ({error})"
        raise InputError(_shown(address), what, 'pip install "psycopg[binary]"') from None


def _shown(address: sa.URL) -> str:
    return address.render_as_string(hide_password=True)


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
    table = "alembic_version_" + service_package.removeprefix("wayline_")
    scripts = ScriptDirectory.from_config(config)
    with engine.connect() as connection:
        there = MigrationContext.configure(connection, opts={"version_table": table})
        current = there.get_current_revision()
    if current == scripts.get_current_head():
        return
    known = {script.revision for script in scripts.walk_revisions()}
    if current is not None and current not in known:
        raise InputError(
            _shown(engine.url),
            f"was written by a newer version ({service_package} {current})",
            "update Wayline or name another database",
        )
    with write_transaction(engine) as connection:
        config.attributes.update(connection=connection, version_table=table)
        command.upgrade(config, "head")
