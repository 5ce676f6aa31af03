"""What each service contributes to a replay, found by the table of services."""

from collections.abc import Iterator
from importlib import import_module
from types import ModuleType

from wayline.drive import Drive
from wayline.node import Node
from wayline.received import Recording
from wayline.replayed_drive import ReplayedDrive
from wayline.services import SERVICES, Replayed


def recordings(drive: Drive, where: str) -> list[Recording]:
    """A drive's sources, service after service; `where` names its file in errors.

    Raises InputError.
    """
    sources = _modules(Replayed.AS_SOURCE)
    return [recording for module in sources for recording in module.recordings(drive, where)]


def nodes(replay: ReplayedDrive) -> list[Node]:
    """The services' cores behind the sources, upstream first. Raises InputError."""
    return [module.node(replay) for module in _modules(Replayed.AS_NODE)]


def _modules(part: Replayed) -> Iterator[ModuleType]:
    """The modules in which services say how they take part."""
    for row in SERVICES.values():
        if row.replayed is part:
            yield import_module(f"{row.package}.{part.value}")
