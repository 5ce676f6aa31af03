"""How a service does: what it lacks, its `health`, and what the probes are told."""

import logging
import time
from collections.abc import Iterator

import zenoh

from wayline import __version__
from wayline.host_clock import told_ns
from wayline.http import Healthz
from wayline.inbox import Inbox
from wayline.messages import Health, Missing
from wayline.readiness import Hearing, Lack, Readiness
from wayline.rfc3339 import rfc3339
from wayline.service import Service
from wayline.settings import Settings
from wayline.telemetry import Telemetry, joined

STUCK_S = 10.0
"""A loop that has not turned this long is not well."""
STARTING = (Missing(subject="service", what="starting", since_ns=told_ns()),)

log = logging.getLogger("wayline")


class Condition:
    """Looks once a second at a service's loop, inbox, feeds, store and router."""

    def __init__(
        self,
        service: Service,
        settings: Settings,
        session: zenoh.Session,
        inbox: Inbox,
        telemetry: Telemetry,
    ) -> None:
        self._service, self._session = service, session
        self._where = ", ".join(settings.bus.connect)
        self._inbox, self._telemetry = inbox, telemetry
        self._hearing = Hearing()
        self._readiness = Readiness()
        self._turned_s = time.monotonic()
        self._health: Health | None = None
        self._last_drop_count = 0

    def turn(self, now_s: float) -> None:
        """The loop goes on; `now_s` is of the monotonic clock."""
        self._turned_s = now_s

    def hear(self, now_s: float) -> None:
        """Something came of what the service works with."""
        self._hearing.hear(now_s)

    def look(self, now_s: float) -> Health:
        """The `health` message of now; new drops are logged."""
        service, inbox, now_ns = self._service, self._inbox, told_ns()
        self._readiness.note(self._lacks(now_s), now_s)
        reporting = (*service.feeds, service.store)
        said = [*(each.detail for each in reporting if each), service.notice()]
        details = joined([each for each in said if each])
        health = self._health = self._telemetry.health(
            now_ns,
            now_s,
            backlog=inbox.backlog,
            dropped=inbox.dropped,
            bad_input=service.bad_input(),
            detail=details or None,
            missing=self._readiness.missing(now_s, now_ns),
        )
        if health.dropped > self._last_drop_count:
            log.warning("%d messages dropped so far%s", health.dropped, self._most_dropped())
            self._last_drop_count = health.dropped
        return health

    def healthz(self) -> Healthz:
        """What the probes answer: alive while the loop turns, ready where nothing is missing."""
        stuck_s = time.monotonic() - self._turned_s
        alive = stuck_s < STUCK_S
        missing = self._health.missing if self._health is not None else STARTING
        wrong = [] if alive else [f"the loop has not turned for {stuck_s:.0f} s"]
        wrong += [f"{each.subject}: {each.what} since {rfc3339(each.since_ns)}" for each in missing]
        return Healthz(
            ok=alive and not missing,
            service=self._service.name,
            version=__version__,
            alive=alive,
            detail="; ".join(wrong) or None,
            missing=missing,
            health=self._health,
        )

    def _lacks(self, now_s: float) -> Iterator[Lack]:
        """What there is not of that which the service works with."""
        service = self._service
        if not self._session.info.routers_zid():
            yield Lack("router", f"the bus is gone: no router at {self._where}")
        for feed in service.feeds:
            if (problem := feed.problem) is not None:
                yield Lack(feed.name, problem)
        if service.store is not None and (problem := service.store.problem) is not None:
            yield Lack("database", problem)
        if service.inputs and self._hearing.is_silent(now_s):
            topics = ", ".join(sorted(kind.topic for kind in service.inputs))
            yield Lack("input", f"nothing is heard of {topics}")

    def _most_dropped(self) -> str:
        """Of whom the inbox has just dropped most."""
        most = self._inbox.take_dropped().most_common(1)
        return f", just now {most[0][1]} of {most[0][0]}" if most else ""
