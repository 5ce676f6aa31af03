"""Pure: which of several places of one quantity is read."""

SILENT_NS = 2_000_000_000
"""A place that has had no value this long gives way to the next one in the list."""


class Preference:
    """The first place that says something; the next ones only while those before are silent."""

    def __init__(self) -> None:
        self._read: dict[str, tuple[int, int]] = {}
        """By quantity: the place that is read, and when it last had a value."""

    def admits(self, quantity: str, rank: int, t_ns: int, *, is_known: bool) -> bool:
        """Whether what the place of this rank says, a value or that there is none, counts."""
        read, heard_ns = self._read.get(quantity, (rank, t_ns))
        if not is_known:
            return rank == read
        if rank > read and t_ns - heard_ns <= SILENT_NS:
            return False
        self._read[quantity] = (rank, t_ns)
        return True
