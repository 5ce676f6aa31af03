"""Pure: one instant by the host's two clocks, and what it makes of a receipt."""

from typing import NamedTuple

from wayline.rfc3339 import rfc3339
from wayline.view import Receipt


class Instant(NamedTuple):
    """Read from both clocks at once."""

    wall_ns: int
    """Unix time; it may step."""
    monotonic_ns: int
    """The clock of receipts."""

    @property
    def text(self) -> str:
        """The wall clock's time."""
        return rfc3339(self.wall_ns)

    def heard(self, receipt: Receipt) -> str:
        """The wall clock's time as long ago as what the receipt tells of is old.

        The difference from `text` is the age, whatever steps the wall clock has made since.
        """
        return rfc3339(self.wall_ns - round(receipt.age_s(self.monotonic_ns) * 1e9))
