"""Writes a replay's messages as JSON lines, one file a topic."""

from pathlib import Path
from types import TracebackType

import msgspec

from wayline.codec import encode
from wayline.errors import InputError
from wayline.messages import TOPICS, Message


class JsonLines:
    """`<folder>/<topic>.jsonl` for every topic but `health`; one message a line.

    `vehicle_id` and `source` stand before the message's own fields.
    """

    def __init__(self, folder: Path, vehicle_id: str) -> None:
        self.counts: dict[str, int] = dict.fromkeys(TOPICS, 0)
        del self.counts["health"]
        self._vehicle = msgspec.json.encode(vehicle_id)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._files = {topic: (folder / f"{topic}.jsonl").open("wb") for topic in self.counts}
        except OSError as error:
            reason = error.strerror or str(error)
            raise InputError(str(folder), reason, "name a folder that can be written") from None

    def __enter__(self) -> "JsonLines":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for file in self._files.values():
            file.close()

    def write(self, message: Message, source: str) -> None:
        """Append one message to its topic's file."""
        file = self._files.get(message.topic)
        if file is None:
            return
        self.counts[message.topic] += 1
        head = b'{"vehicle_id":%b,"source":%b,' % (self._vehicle, msgspec.json.encode(source))
        file.write(head + encode(message)[1:] + b"\n")
