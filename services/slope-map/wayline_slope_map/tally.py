"""How often something was left out of the map since the process began, by reason."""

from collections.abc import Mapping


class Tally:
    """Counted in one thread, read in any."""

    def __init__(self) -> None:
        self._counts: Mapping[str, int] = {}

    @property
    def counts(self) -> Mapping[str, int]:
        """How many parts of drives, by reason."""
        return self._counts

    def count(self, reason: str) -> None:
        """One part more."""
        # replaced, never changed: whoever reads it goes through it undisturbed
        self._counts = {**self._counts, reason: self._counts.get(reason, 0) + 1}

    def notice(self) -> str | None:
        """What `health` should say; None where nothing was left out."""
        said = [f"{count} x {reason}" for reason, count in self._counts.items()]
        return f"left out of the map: {', '.join(said)}" if said else None
