"""Whether a CAN interface opens, and what to mend where it does not."""

from wayline.errors import InputError
from wayline.live_sources import LiveCan
from wayline_can_ingest.bus_reader import DRIVER_ERRORS, open_bus


def try_can(source: LiveCan) -> str | None:
    """Open and close an interface as can-ingest would; why it does not open, None if it does."""
    try:
        with open_bus(source):
            return None
    except (*DRIVER_ERRORS, ImportError) as error:
        return " ".join(str(error).split()) or type(error).__name__


def not_opened(source: LiveCan, problem: str) -> InputError:
    """The error of an interface that does not open, with the mend of its kind."""
    if source.interface == "socketcan":
        bitrate = source.bitrate or 500_000
        mend = f"ip link set {source.channel} up type can bitrate {bitrate}, or correct [[can]]"
    else:
        mend = "plug the adapter in, install its driver, or correct [[can]]"
    return InputError(named(source), f"does not open ({problem})", mend)


def named(source: LiveCan) -> str:
    """How findings call an interface."""
    return f"CAN {source.interface} {source.channel}"
