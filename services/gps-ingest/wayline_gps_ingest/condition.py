"""Pure: how a receiver does, in one line for people."""

from collections.abc import Mapping

import msgspec

SILENT_S = 5.0
"""Nothing for longer is worth saying: five times what a slow receiver takes for a fix."""


class Condition(msgspec.Struct, frozen=True, kw_only=True):
    """A receiver and its link at one moment; ages are None for never."""

    url: str
    link_error: str | None = None
    """Why there is no connection; None while there is one."""
    note: str | None = None
    """What else is known of the link, e.g. its rate."""
    byte_age_s: float | None = None
    sentence_age_s: float | None = None
    fix_age_s: float | None = None
    reconnections: int = 0
    faults: Mapping[str, int] = {}

    @property
    def problem(self) -> str | None:
        """What is wrong, the deepest cause first; None where fixes come."""
        return self.absence or ("without a fix" if _is_old(self.fix_age_s) else None)

    @property
    def absence(self) -> str | None:
        """Why nothing is heard; None where the receiver speaks, with or without a fix."""
        if self.link_error is not None:
            return f"not connected ({self.link_error})"
        if _is_old(self.byte_age_s):
            return "silent"
        if _is_old(self.sentence_age_s):
            return "sends nothing readable"
        return None

    @property
    def text(self) -> str:
        """The line that `health` shows."""
        state = self.problem or "well"
        parts = [f"{state}, {self.note}" if self.note else state]
        parts.append(f"last sentence {_ago(self.sentence_age_s)}")
        parts.append(f"last fix {_ago(self.fix_age_s)}")
        if self.reconnections:
            parts.append(f"{self.reconnections} reconnections")
        parts += [f"{times} {reason}" for reason, times in sorted(self.faults.items())]
        return f"{self.url}: {', '.join(parts)}"


def _is_old(age_s: float | None) -> bool:
    return age_s is None or age_s > SILENT_S


def _ago(age_s: float | None) -> str:
    return "never" if age_s is None else f"{age_s:.1f} s ago"
