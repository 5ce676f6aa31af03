"""A service's HTTP from the start of its process to the end, whatever becomes of the bus."""

import contextlib
import logging
from collections.abc import Callable, Iterator

from wayline import __version__
from wayline.host_clock import told_ns
from wayline.http import Healthz
from wayline.http_server import HttpServer
from wayline.messages import Missing
from wayline.rfc3339 import rfc3339
from wayline.service import Service
from wayline.settings import Settings
from wayline.telemetry import Telemetry

log = logging.getLogger("wayline")


class Front:
    """Answers the probes while the process waits for its router, then as its loop says."""

    def __init__(self, service: Service, settings: Settings, telemetry: Telemetry) -> None:
        self._service, self._settings, self._telemetry = service, settings, telemetry
        where = ", ".join(settings.bus.connect)
        what = f"the bus is gone: no router at {where}"
        self._waiting = Missing(subject="router", what=what, since_ns=told_ns())
        self.ask: Callable[[], Healthz] = self._wait
        """The loop's word, once there is a loop."""

    def healthz(self) -> Healthz:
        """What the probes answer."""
        return self.ask()

    @contextlib.contextmanager
    def serving(self) -> Iterator[None]:
        """Listen while the block runs. Raises InputError where that cannot be."""
        if self._service.make_app is None:
            yield
            return
        app = self._service.make_app(self.healthz, self._telemetry)
        with HttpServer(app, self._settings.http_of(self._service.name)) as server:
            log.info("%s answers on %s", self._service.name, server.url)
            yield

    def _wait(self) -> Healthz:
        missing = self._waiting
        return Healthz(
            ok=False,
            service=self._service.name,
            version=__version__,
            detail=f"{missing.subject}: {missing.what} since {rfc3339(missing.since_ns)}",
            missing=(missing,),
        )
