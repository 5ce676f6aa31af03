"""Fusion watched live in Rerun, where the configuration wants it."""

import logging
from pathlib import Path

from wayline.route import Route
from wayline.service import Watch
from wayline.settings import Settings
from wayline.shell import load_routes

log = logging.getLogger("wayline")


def live_view(settings: Settings) -> Watch | None:
    """What to tell of every message; None where no view is wanted. Raises InputError."""
    rerun = settings.rerun
    if not rerun.enabled:
        return None
    # the SDK is large and an extra of its own; a vehicle without a view does not need it
    from wayline.rerun_view import RerunRecording  # noqa: PLC0415

    recording = RerunRecording(
        save=Path(rerun.record) if rerun.record else None,
        port=rerun.port,
        routes=_route_by_vehicle(settings),
        memory_limit=rerun.memory_limit,
    )
    log.info("watch fusion with: rerun %s", recording.address)
    return recording.log


def _route_by_vehicle(settings: Settings) -> dict[str, Route]:
    """The one configured route, for each vehicle named; of several it is not known whose."""
    routes = load_routes(settings)
    return dict.fromkeys(settings.served(), routes[0]) if len(routes) == 1 else {}
