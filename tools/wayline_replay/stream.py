"""A drive's messages in order of receipt, from all its recordings."""

import heapq
from collections.abc import Iterator

from wayline.drive import Drive
from wayline.received import Received, in_order
from wayline_replay.parts import recordings


class DriveStream:
    """Iterates once over a drive's messages in order of receipt.

    `where` names the drive file in errors. Raises InputError.
    """

    def __init__(self, drive: Drive, where: str) -> None:
        self._recordings = recordings(drive, where)

    def __iter__(self) -> Iterator[Received]:
        return heapq.merge(
            *(in_order(order, recording) for order, recording in enumerate(self._recordings)),
            key=lambda received: received[:2],
        )

    @property
    def bad_input(self) -> dict[str, int]:
        """Sentences, rows and frames that were counted and dropped so far, by source."""
        return {recording.source: recording.bad_input() for recording in self._recordings}
