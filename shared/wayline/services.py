"""Pure: the table of services. Whatever goes over all of them reads it, and no other place does.

A new service is a row here, a folder under `services`, and its lines in pyproject.toml and
`deploy`, which tests/unit/wayline/test_services.py compares with the table.
"""

from enum import Enum
from typing import NamedTuple


class Replayed(Enum):
    """How a service takes part when a drive is replayed in one process."""

    AS_SOURCE = "recorded"
    """The service's module `recorded` has `recordings(drive, where) -> list[Recording]`."""
    AS_NODE = "replayed"
    """The service's module `replayed` has `node(replay: ReplayedDrive) -> Node`."""
    NOT = None
    """The service publishes nothing that is kept."""


class Tables(NamedTuple):
    """A database of a service's own, with its migrations in `<package>/migrations`."""

    lost_without: str | None
    """What is lost where no database is named; None: the service does not start without one."""


class ServiceRow(NamedTuple):
    """One service, and what configuration, commands and checks have to know of it."""

    name: str
    """On the bus, of its command (`wayline-<name>`) and of its extra (`wayline[<name>]`)."""
    port: int
    """Where its HTTP listens if the configuration names no other port (SPEC section 5)."""
    modules: tuple[str, ...]
    """What the service imports that the extra of its name installs."""
    replayed: Replayed
    tables: Tables | None = None
    shows: str | None = None
    """What its HTTP answers about, in a word; None: nothing but its health."""

    @property
    def package(self) -> str:
        """Its Python package, in `services/<name>`."""
        return "wayline_" + self.name.replace("-", "_")

    @property
    def command(self) -> str:
        """What starts it."""
        return f"wayline-{self.name}"

    @property
    def reads_sensors(self) -> bool:
        """Whether it belongs to the one vehicle whose sensors this machine reads."""
        return self.replayed is Replayed.AS_SOURCE


_ROWS = (
    ServiceRow(
        "gps-ingest", 8004, ("google.transit", "httpx2", "pynmea2", "serial"), Replayed.AS_SOURCE
    ),
    ServiceRow("can-ingest", 8005, ("can", "cantools", "isotp"), Replayed.AS_SOURCE),
    ServiceRow(
        "fusion",
        8003,
        ("filterpy",),
        Replayed.AS_NODE,
        tables=Tables(lost_without="calibration is lost at a restart"),
    ),
    ServiceRow(
        "eta",
        8001,
        ("filterpy", "google.transit"),
        Replayed.AS_NODE,
        tables=Tables(lost_without="what was learned of travel times is lost at a restart"),
        shows="arrivals",
    ),
    ServiceRow(
        "slope-map",
        8002,
        ("filterpy", "sqlalchemy", "alembic"),
        Replayed.AS_NODE,
        tables=Tables(lost_without=None),
        shows="slopes",
    ),
    ServiceRow(
        "history",
        8006,
        ("fastapi", "scipy", "sqlalchemy", "alembic"),
        Replayed.AS_NODE,
        tables=Tables(lost_without=None),
        shows="history",
    ),
    ServiceRow("dashboard", 8000, ("fastapi", "uvicorn", "httpx2"), Replayed.NOT, shows="view"),
)
SERVICES = {row.name: row for row in _ROWS}
"""By name, in the order in which data flows through them."""
