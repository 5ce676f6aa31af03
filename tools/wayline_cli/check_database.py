"""The doctor's checks of databases: reachable, and their tables known. Nothing is written."""

from importlib.resources import files
from pathlib import Path

import sqlalchemy as sa
from alembic.config import Config
from alembic.script import ScriptDirectory

from wayline.database_address import is_sqlite, parsed_address, shown
from wayline.errors import InputError

CONNECT_TIMEOUT_S = 3


def database_finding(url: str, service: str, package: str) -> str:
    """How a service, whose migrations are in `package`, would find its database.

    Raises InputError where it could not use it.
    """
    address = parsed_address(url)
    place = shown(address)
    path = Path(address.database or "")
    if is_sqlite(address):
        if not path.parent.is_dir():
            raise InputError(place, f"no folder {path.parent}", "create it or correct the address")
        if not path.exists():
            return f"{path} is made when {service} starts"
    try:
        revision = _revision(_read_only(address), f"alembic_version_{service.replace('-', '_')}")
    except sa.exc.DBAPIError as error:
        mend = "check the address and its rights"
        raise InputError(place, f"cannot be opened ({error.orig})", mend) from None
    except (ImportError, sa.exc.NoSuchModuleError) as error:
        what = f"its database driver is not installed ({error})"
        raise InputError(place, what, 'pip install "wayline[postgres]"') from None
    return _schema_finding(place, package, service, revision)


def _read_only(address: sa.URL) -> sa.Engine:
    if not is_sqlite(address):
        return sa.create_engine(address, connect_args={"connect_timeout": CONNECT_TIMEOUT_S})
    location = Path(address.database or "").absolute().as_uri()
    query = {"mode": "ro", "uri": "true"}
    return sa.create_engine(address.set(database=location, query=query))


def _revision(engine: sa.Engine, version_table: str) -> str | None:
    """The revision of a service's tables; None where it has none yet."""
    try:
        with engine.connect() as connection:
            if not sa.inspect(connection).has_table(version_table):
                return None
            version = sa.table(version_table, sa.column("version_num", sa.String))
            return connection.execute(sa.select(version.c.version_num)).scalar_one_or_none()
    finally:
        engine.dispose()


def _schema_finding(place: str, package: str, service: str, revision: str | None) -> str:
    config = Config()
    config.set_main_option("script_location", str(files(package) / "migrations").replace("%", "%%"))
    config.set_main_option("path_separator", "os")
    scripts = ScriptDirectory.from_config(config)
    if revision is None:
        return f"reachable, {service} makes its tables when it starts"
    if revision == scripts.get_current_head():
        return f"reachable, tables of {service} up to date"
    if revision in {script.revision for script in scripts.walk_revisions()}:
        return f"reachable, {service} brings its tables up to date when it starts"
    what = f"was written by a newer version ({package} {revision})"
    raise InputError(place, what, "update Wayline or name another database")
