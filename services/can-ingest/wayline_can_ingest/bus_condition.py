"""Pure: how a bus does, in one line for people."""

from collections.abc import Mapping

import msgspec

SILENT_S = 3.0
"""Nothing mapped for longer is worth saying: any quantity comes more often than that."""


class BusCondition(msgspec.Struct, frozen=True, kw_only=True):
    """A bus and its interface at one moment; ages are None for never."""

    name: str
    """Interface and channel."""
    link_error: str | None = None
    """Why it is not open; None while it is."""
    state: str | None = None
    """What the controller said of itself, e.g. bus-off."""
    note: str | None = None
    """What else is known, e.g. of the polling."""
    frame_age_s: float | None = None
    mapped_age_s: float | None = None
    reconnections: int = 0
    faults: Mapping[str, int] = {}

    @property
    def problem(self) -> str | None:
        """What is wrong, the deepest cause first; None where mapped frames come."""
        if self.link_error is not None:
            return f"not open ({self.link_error})"
        if not _is_old(self.mapped_age_s):
            return None
        if self.state is not None:
            return self.state
        return "silent" if _is_old(self.frame_age_s) else "no mapped frame"

    @property
    def text(self) -> str:
        """The line that `health` shows."""
        state = self.problem or "well"
        parts = [f"{state}, {self.note}" if self.note else state]
        parts.append(f"last frame {_ago(self.frame_age_s)}")
        parts.append(f"last mapped frame {_ago(self.mapped_age_s)}")
        if self.reconnections:
            parts.append(f"{self.reconnections} reconnections")
        parts += [f"{times} {reason}" for reason, times in sorted(self.faults.items())]
        return f"{self.name}: {', '.join(parts)}"


def _is_old(age_s: float | None) -> bool:
    return age_s is None or age_s > SILENT_S


def _ago(age_s: float | None) -> str:
    return "never" if age_s is None else f"{age_s:.1f} s ago"
