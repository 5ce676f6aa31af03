"""Opens a session for a command that a person runs: it says so when there is no router yet."""

from collections.abc import Callable

import zenoh

from wayline.bus import open_session
from wayline.ending import Ending, unless_ended
from wayline.settings import BusSettings

PATIENCE_S = 1.0


def open_or_stop(
    settings: BusSettings, ending: Ending, say: Callable[[str], None]
) -> zenoh.Session | None:
    """A session on the bus, as soon as its router is there; None when stopped before.

    Raises InputError as `open_session` does.
    """
    where = ", ".join(settings.connect)
    return unless_ended(
        lambda: open_session(settings),
        ending,
        patience_s=PATIENCE_S,
        waiting=lambda: say(f"waiting for a router at {where}"),
    )
