"""Pure: counts what a service does, for `health` and for Prometheus."""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram

from wayline import __version__
from wayline.messages import TEXT_MAX, Health, Missing

LAGS_KEPT = 2_000
SEPARATOR = "; "
NAME_MAX = 24
LAG_BUCKETS_S = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
FAULTS_KEPT = 10
"""Told once a second: faults are those of the last ten seconds, for nobody sees a single one."""


def joined(details: Sequence[str]) -> str:
    """Details as one text of a message.

    Where that is too long, of a long name before `: ` its end is left, then the longest are cut
    alike.
    """
    if len(SEPARATOR.join(details)) > TEXT_MAX:
        details = [_shortly_named(each) for each in details]
    room = TEXT_MAX - len(SEPARATOR) * max(len(details) - 1, 0)
    most = room
    for place, length in enumerate(sorted(map(len, details))):
        most = room // (len(details) - place)
        if length > most:
            break
        room -= length
    return SEPARATOR.join(_cut(each, max(most, 1)) for each in details)[:TEXT_MAX]


def _shortly_named(detail: str) -> str:
    name, colon, said = detail.partition(": ")
    short = name if len(name) <= NAME_MAX else "…" + name[1 - NAME_MAX :]
    return f"{short}{colon}{said}" if colon else detail


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else text[: most - 1] + "…"


class Counts(NamedTuple):
    """What had been counted at an instant of the monotonic clock."""

    at_s: float
    received: int = 0
    published: int = 0
    dropped: int = 0
    bad_input: int = 0


class Telemetry:
    """Counters of one service since its start, `started_s` by the monotonic clock."""

    def __init__(
        self, service: str, started_ns: int, started_s: float = 0.0, *, recorded: bool = False
    ) -> None:
        self.registry = CollectorRegistry()
        self._service, self._started_ns, self._recorded = service, started_ns, recorded
        self._received = 0
        self._published = 0
        self.lost_count = 0
        """Samples that never came."""
        self._bad_input = 0
        self._lags_s: deque[float] = deque(maxlen=LAGS_KEPT)
        self._last = Counts(started_s)
        self._faults = deque([self._last], maxlen=FAULTS_KEPT)
        """One a second, the oldest first."""
        self._in = Counter("wayline_messages_in", "Heard", ["topic"], registry=self.registry)
        self._out = Counter("wayline_messages_out", "Published", ["topic"], registry=self.registry)
        self._dropped = Gauge(
            "wayline_dropped", "Dropped by the inbox or lost on the bus", registry=self.registry
        )
        self._bad = Gauge("wayline_bad_input", "Counted and dropped", registry=self.registry)
        self._backlog = Gauge("wayline_backlog", "Waiting in the inbox", registry=self.registry)
        self._lag = Histogram(
            "wayline_lag_seconds",
            "From receipt to being taken from the inbox",
            buckets=LAG_BUCKETS_S,
            registry=self.registry,
        )

    def heard(self, topic: str, waited_ns: int) -> None:
        """A message was taken, so long after its receipt."""
        self.took(waited_ns)
        self._in.labels(topic).inc()

    def took(self, waited_ns: int) -> None:
        """Something was taken that was not a bus message, so long after its receipt."""
        self._received += 1
        self._lags_s.append(waited_ns * 1e-9)
        self._lag.observe(waited_ns * 1e-9)

    def published(self, topic: str) -> None:
        """A message went out."""
        self._published += 1
        self._out.labels(topic).inc()

    def lost(self, count: int) -> None:
        """Samples were lost on the bus for good."""
        self.lost_count += count

    def bad(self) -> None:
        """Something could not be read and was dropped."""
        self._bad_input += 1

    def health(
        self,
        now_ns: int,
        now_s: float,
        *,
        backlog: int,
        dropped: int,
        bad_input: int,
        detail: str | None,
        missing: tuple[Missing, ...] = (),
    ) -> Health:
        """The `health` message of now, by Unix time and by the monotonic clock.

        Rates are those since the last one, of faults those of the last ten.
        """
        p50, p99 = self._lag_quantiles_ms()
        now = Counts(
            now_s,
            self._received,
            self._published,
            dropped + self.lost_count,
            bad_input + self._bad_input,
        )
        last, then = self._last, self._faults[0]
        self._last = now
        self._faults.append(now)
        self._dropped.set(now.dropped)
        self._bad.set(now.bad_input)
        self._backlog.set(backlog)
        return Health(
            t_ns=now_ns,
            service=self._service,
            version=__version__,
            started_ns=self._started_ns,
            in_rate_hz=_rate_hz(now.received - last.received, now_s - last.at_s),
            out_rate_hz=_rate_hz(now.published - last.published, now_s - last.at_s),
            backlog=backlog,
            dropped=now.dropped,
            dropped_rate_hz=_rate_hz(now.dropped - then.dropped, now_s - then.at_s),
            bad_input=now.bad_input,
            bad_input_rate_hz=_rate_hz(now.bad_input - then.bad_input, now_s - then.at_s),
            lag_ms_p50=p50,
            lag_ms_p99=p99,
            detail=detail,
            missing=missing,
            recorded=self._recorded,
        )

    def _lag_quantiles_ms(self) -> tuple[float | None, float | None]:
        if not self._lags_s:
            return None, None
        p50, p99 = np.quantile(np.array(self._lags_s), [0.5, 0.99]) * 1e3
        return float(p50), float(p99)


def _rate_hz(count: int, elapsed_s: float) -> float:
    return max(count, 0) / max(elapsed_s, 1e-3)
