"""Opens a session for a command that a person runs: it says so when there is no router yet."""

from collections.abc import Callable

import zenoh

from wayline.bus import open_session
from wayline.settings import BusSettings
from wayline.stop import Stop, unless_stopped

PATIENCE_S = 1.0


def open_or_stop(
    settings: BusSettings, stop: Stop, say: Callable[[str], None]
) -> zenoh.Session | None:
    """A session on the bus, as soon as its router is there; None when stopped before.

    Raises InputError as `open_session` does.
    """
    where = ", ".join(settings.connect)
    return unless_stopped(
        lambda: open_session(settings),
        stop,
        patience_s=PATIENCE_S,
        waiting=lambda: say(f"waiting for a router at {where}"),
    )
