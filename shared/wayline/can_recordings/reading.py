"""What every reader of a recording is."""

from collections.abc import Iterator
from typing import Protocol

import can


class Reading(Protocol):
    """Frames of one recording as python-can has them; what is damaged is left out and counted.

    A time before 1980 is the recording's own, which carries no date. Raises UnreadableError where
    nothing can be made of the file, OSError where the disk fails.
    """

    is_local: bool
    """Whether its dates are of the clock on a wall, so that a time zone has to tell which."""
    first_channel: int
    """What the file itself calls the channel that python-can calls 0."""

    @property
    def is_dated(self) -> bool | None:
        """Whether its times have a date, where its header tells; None where only they do."""

    @property
    def damaged(self) -> int:
        """Lines, records and endings that were left out so far."""

    def __iter__(self) -> Iterator[can.Message]:
        """Read it from its beginning, once."""

    def close(self) -> None:
        """Close its file."""
