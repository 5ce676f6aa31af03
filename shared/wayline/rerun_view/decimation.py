"""Pure: thins what arrives faster than an eye follows."""


class Decimator:
    """Lets a name through once a period of measurement time."""

    def __init__(self, period_ns: int) -> None:
        self._period_ns = period_ns
        self._last_ns: dict[str, int] = {}

    def is_due(self, name: str, t_ns: int) -> bool:
        """Whether this one is let through; a clock that stepped back starts afresh."""
        last_ns = self._last_ns.get(name)
        if last_ns is not None and 0 <= t_ns - last_ns < self._period_ns:
            return False
        self._last_ns[name] = t_ns
        return True
