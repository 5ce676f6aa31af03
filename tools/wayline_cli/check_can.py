"""The doctor's check of CAN interfaces."""

from collections.abc import Callable, Sequence

from wayline.live_sources import LiveCan
from wayline_can_ingest.diagnosis.opening import named, not_opened
from wayline_cli.check import Check, fine, wrong

OpenCan = Callable[[LiveCan], str | None]
"""Why an interface does not open, None where it does."""


def check_can(interfaces: Sequence[LiveCan], open_can: OpenCan) -> list[Check]:
    """Whether each configured CAN interface opens."""
    return [_check_interface(interface, open_can(interface)) for interface in interfaces]


def _check_interface(source: LiveCan, problem: str | None) -> Check:
    if problem is None:
        return fine(named(source), "opens")
    error = not_opened(source, problem)
    return wrong(error.where, error.what, error.mend)
