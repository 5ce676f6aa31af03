"""The doctor's checks of databases: reachable, and their tables known. Nothing is written."""

from importlib.resources import files
from pathlib import Path

import sqlalchemy as sa
from alembic.config import Config
from alembic.script import ScriptDirectory

from wayline.errors import InputError

ADDRESS_MEND = "use sqlite:///FILE or postgresql://user@host/name"
CONNECT_TIMEOUT_S = 3


def database_finding(url: str, service: str, package: str) -> str:
    """How a service, whose migrations are in `package`, would find its database.

    Raises InputError where it could not use it.
    """
    address = _parsed(url)
    shown = address.render_as_string(hide_password=True)
    path = Path(address.database or "")
    if _is_sqlite(address):
        if not path.parent.is_dir():
            raise InputError(shown, f"no folder {path.parent}", "create it or correct the address")
        if not path.exists():
            return f"{path} is made when {service} starts"
    try:
        revision = _revision(_read_only(address), f"alembic_version_{service.replace('-', '_')}")
    except sa.exc.DBAPIError as error:
        mend = "check the address and its rights"
        raise InputError(shown, f"cannot be opened ({error.orig})", mend) from None
    except (ImportError, sa.exc.NoSuchModuleError) as error:
        what = f"its database driver is not installed ({error})"
        raise InputError(shown, what, 'pip install "wayline[postgres]"') from None
    return _schema_finding(shown, package, service, revision)


def _parsed(url: str) -> sa.URL:
    try:
        address = sa.make_url(url)
    except sa.exc.ArgumentError:
        raise InputError(url, "is not a database address", ADDRESS_MEND) from None
    if address.get_backend_name() not in {"sqlite", "postgresql"}:
        shown = address.render_as_string(hide_password=True)
        raise InputError(shown, "is a kind of database that is not known", ADDRESS_MEND)
    return address


def _is_sqlite(address: sa.URL) -> bool:
    return address.get_backend_name() == "sqlite"


def _read_only(address: sa.URL) -> sa.Engine:
    if not _is_sqlite(address):
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


def _schema_finding(shown: str, package: str, service: str, revision: str | None) -> str:
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
    raise InputError(shown, what, "update Wayline or name another database")
