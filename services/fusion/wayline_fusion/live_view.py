"""Fusion watched live in Rerun, where the configuration wants it."""

import logging
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from wayline.messages import Message
from wayline.settings import Settings
from wayline.shell import load_routes
from wayline.view import Receipt, View

log = logging.getLogger("wayline")


class RerunView:
    """Logs what fusion hears and publishes."""

    reads: ClassVar[frozenset[type[Message]]] = frozenset()

    def __init__(self, log_message: Callable[[str, Message, str], None]) -> None:
        self._log_message = log_message

    def put(self, vehicle_id: str, message: Message, source: str, receipt: Receipt) -> None:
        """Take a message; the view's own times are those of the messages."""
        del receipt
        self._log_message(vehicle_id, message, source)

    def forget(self, vehicle_id: str) -> None:
        """What was logged stays in the recording."""


def live_views(settings: Settings) -> list[View]:
    """The view in Rerun, where one is wanted. Raises InputError."""
    rerun = settings.rerun
    if not rerun.enabled:
        return []
    # the SDK is large and an extra of its own; a vehicle without a view does not need it
    from wayline.rerun_view import RerunRecording  # noqa: PLC0415

    recording = RerunRecording(
        save=Path(rerun.record) if rerun.record else None,
        port=rerun.port,
        routes=dict.fromkeys(settings.served(), load_routes(settings)),
        memory_limit=rerun.memory_limit,
    )
    log.info("watch fusion with: rerun %s", recording.address)
    return [RerunView(recording.log)]
