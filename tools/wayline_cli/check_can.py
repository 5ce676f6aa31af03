"""The doctor's check of CAN interfaces."""

from collections.abc import Callable, Sequence

from wayline.settings import LiveCan
from wayline_can_ingest.bus_reader import DRIVER_ERRORS, open_bus
from wayline_cli.check import Check, fine, wrong

OpenCan = Callable[[LiveCan], str | None]
"""Why an interface does not open, None where it does."""


def check_can(interfaces: Sequence[LiveCan], open_can: OpenCan) -> list[Check]:
    """Whether each configured CAN interface opens."""
    return [_check_interface(interface, open_can) for interface in interfaces]


def _check_interface(source: LiveCan, open_can: OpenCan) -> Check:
    subject, problem = f"CAN {source.interface} {source.channel}", open_can(source)
    if problem is None:
        return fine(subject, "opens")
    if source.interface == "socketcan":
        bitrate = source.bitrate or 500_000
        mend = f"ip link set {source.channel} up type can bitrate {bitrate}, or correct [[can]]"
    else:
        mend = "plug the adapter in, install its driver, or correct [[can]]"
    return wrong(subject, f"does not open ({problem})", mend)


def try_can(source: LiveCan) -> str | None:
    """Open an interface as can-ingest would, and close it."""
    try:
        with open_bus(source):
            return None
    except (*DRIVER_ERRORS, ImportError) as error:
        return " ".join(str(error).split()) or type(error).__name__
