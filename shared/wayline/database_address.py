"""Reads the address of a database, and shows it without its secrets."""

import sqlalchemy as sa

from wayline.errors import InputError

DIALECTS = ("sqlite", "postgresql")
PORT_MAX = 65_535
WHERE = "database_url"
MEND = "use sqlite:///FILE or postgresql://user@host/name"
IN_PASSWORDS = "write %40 for @, %2F for / and %3A for : in a password"


def parsed_address(url: str) -> sa.URL:
    """The address that a text is, with the driver that Wayline brings.

    Raises InputError, which shows nothing that may be a secret.
    """
    try:
        address = sa.make_url(url)
    except sa.exc.ArgumentError:
        raise _no_address(url) from None
    except ValueError:
        raise InputError(WHERE, "has a port that is no number", IN_PASSWORDS) from None
    if address.get_backend_name() not in DIALECTS:
        what = f"{address.get_backend_name()} is a kind of database that is not known"
        raise InputError(WHERE, what, MEND)
    return address if is_sqlite(address) else _of_server(address)


def is_sqlite(address: sa.URL) -> bool:
    """Whether it is a file's, or memory's."""
    return address.get_backend_name() == "sqlite"


def shown(address: sa.URL) -> str:
    """An address as it may be printed: without user, password and options."""
    return sa.URL.create(
        address.drivername, host=address.host, port=address.port, database=address.database
    ).render_as_string()


def _no_address(url: str) -> InputError:
    """A file's name is shown; whatever has another form may hold a password."""
    if any(mark in url for mark in ":@=?"):
        return InputError(WHERE, "is not a database address", MEND)
    mend = f"write sqlite:///{url} for a file or postgresql://user@host/name for a server"
    return InputError(url, "is not a database address", mend)


def _of_server(address: sa.URL) -> sa.URL:
    # of "me:p@ss/word@host/name" the host would be "ss", the rest the name: both would be shown
    if "@" in f"{address.host}{address.database}":
        raise InputError(WHERE, "has more than one @", IN_PASSWORDS)
    if address.port is not None and not 0 < address.port <= PORT_MAX:
        raise InputError(WHERE, f"has port {address.port}", f"give one from 1 to {PORT_MAX}")
    # the bare name means another driver to SQLAlchemy before 2.1
    is_bare = address.drivername == "postgresql"
    return address.set(drivername="postgresql+psycopg") if is_bare else address
