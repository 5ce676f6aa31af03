"""A service's process from its start to its end: signals, its HTTP, its session, its loop."""

import logging
import sys
import time

from wayline import __version__
from wayline.bus import open_session
from wayline.ending import ending_on_signals, unless_ended
from wayline.front import Front
from wayline.host_clock import told_ns
from wayline.loop import Loop
from wayline.service import Service
from wayline.settings import Settings
from wayline.telemetry import Telemetry

SWITCH_S = 0.0005
"""How long the working thread keeps Python from Zenoh's threads. At Python's own 5 ms a flood is
not heard but piles up in the router, which drops anybody's messages; here it drops its own."""

log = logging.getLogger("wayline")


def run(service: Service, settings: Settings) -> None:
    """Run a service until SIGTERM or Ctrl-C. Raises InputError for bad configuration."""
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(name)s %(message)s")
    logging.getLogger("uvicorn").setLevel(logging.WARNING)
    sys.setswitchinterval(SWITCH_S)
    telemetry = Telemetry(service.name, told_ns(), time.monotonic(), recorded=service.is_recorded)
    front = Front(service, settings, telemetry)
    with ending_on_signals() as ending, front.serving():
        session = unless_ended(
            lambda: open_session(settings.bus),
            ending,
            patience_s=1.0,
            waiting=lambda: log.info("waiting for a router at %s", ", ".join(settings.bus.connect)),
        )
        if session is None:
            return
        with session:
            log.info("%s %s started", service.name, __version__)
            loop = Loop(service, settings, session, ending, telemetry=telemetry)
            front.ask = loop.healthz
            loop.run()
    log.info("%s stopped", service.name)
