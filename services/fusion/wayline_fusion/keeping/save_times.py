"""Pure: when to keep what is known of a vehicle.

Many vehicles take the power away with the ignition, without a word: what was kept when the vehicle
came to rest is then the last. And once nothing is heard any more, what is known only gets worse.
"""

EVERY_NS = 60_000_000_000
AT_REST_NS = 10_000_000_000
"""At the soonest after the last time, so that a queue does not wear out a memory card."""
SILENT_NS = 2_000_000_000
"""Nothing heard for so long."""


class SaveTimes:
    """Says at which ticks to keep: each minute, at rest, and when the sensors fall silent."""

    def __init__(self) -> None:
        self._last_ns = 0
        self._stood = False
        self._silent = True

    def is_due(self, t_ns: int, heard_ns: int | None, *, standing: bool) -> bool:
        """Whether to keep now; `heard_ns` is when a sensor was heard last."""
        silent = is_silent(t_ns, heard_ns)
        fell_silent, self._silent = silent and not self._silent, silent
        came_to_rest = standing and not self._stood and t_ns - self._last_ns >= AT_REST_NS
        self._stood = standing and (self._stood or came_to_rest)
        is_due = fell_silent or (not silent and (came_to_rest or t_ns % EVERY_NS == 0))
        if is_due:
            self._last_ns = t_ns
        return is_due


def is_silent(t_ns: int, heard_ns: int | None) -> bool:
    """Whether the sensors are silent at an instant."""
    return heard_ns is None or t_ns - heard_ns > SILENT_NS
