"""Pure: what came of a fleet as rows, with the bars that are asked of it."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from wayline.messages import Health, Pose
from wayline_bench.fleet_figures import (
    PROCESSES,
    ROUTER,
    SERVICES,
    Bare,
    Counters,
    Fed,
    Lived,
    Load,
    Quiet,
)
from wayline_bench.row import Row, compared

NEWEST = "newest message of each topic"
SILENT_CORE_BAR = 0.01
"""Of a core: what cannot be told from the noise of the machine."""
SILENT_MESSAGES_BAR = 1.1


class Bars(NamedTuple):
    """The largest ratios that will do; None where none is asked for."""

    router: float | None = None
    """CPU beside that of the bare load."""
    missed: float | None = None
    """Of the poses sent."""
    uncounted: float | None = None
    """Of the messages sent: missed, and said nowhere."""


def fleet_rows(load: Load, lived: Lived, bare: Bare, bars: Bars) -> list[Row]:
    """What a fleet cost and what was heard of it."""
    name = f"{load.vehicles} at {load.pose_hz:g} Hz"
    cpu_bars = {ROUTER: bars.router}
    return [
        *(_cpu(name, each, lived, bare, cpu_bars.get(each)) for each in PROCESSES),
        *(row for each in SERVICES for row in _heard(name, each, lived, bars)),
        _bare_missed(name, bare),
        *(_memory(name, each, load, lived) for each in PROCESSES),
        *_page(name, load, lived),
        compared(
            f"{name}: the feeder, a message sent late at worst",
            [lived.fed.late_s],
            [1.0 / load.pose_hz],
            "between poses",
            unit="s",
        ),
    ]


def silent_rows(vehicles: int, before: Quiet, after: Quiet) -> list[Row]:
    """What a fleet costs that has fallen silent, beside what none at all costs."""
    name = f"{vehicles} fell silent a minute ago"
    extra = {each: share - before.core_shares[each] for each, share in after.core_shares.items()}
    return [
        *(
            compared(
                f"{name}: {each}, CPU above that before they came",
                [share],
                [1.0],
                "core",
                bar=SILENT_CORE_BAR,
            )
            for each, share in extra.items()
        ),
        compared(
            f"{name}: messages on the bus",
            [after.messages_hz],
            [before.messages_hz],
            "before they came",
            unit="Hz",
            bar=SILENT_MESSAGES_BAR,
        ),
    ]


def missed(sent: Mapping[str, int], heard: Mapping[str, int]) -> int:
    """How many were not heard of the topics that a listener listens to."""
    return sum(max(count - heard[topic], 0) for topic, count in sent.items() if topic in heard)


def sent_to(service: str, fed: Fed, counters: Mapping[str, Counters]) -> dict[str, int]:
    """What was sent to a service, by topic: by the vehicles, and by the other services.

    Health is left out: services tell their own in the same topic.
    """
    by_services = {
        topic: count
        for name, each in counters.items()
        if name != service
        for topic, count in each.published.items()
    }
    return {topic: n for topic, n in (fed.sent | by_services).items() if topic != Health.topic}


def _cpu(name: str, process: str, lived: Lived, bare: Bare, bar: float | None) -> Row:
    ours, yardstick = (
        [shares[process] for shares in each.fed.core_shares] for each in (lived, bare)
    )
    title = f"{name}: {process}, CPU"
    return compared(title, ours, yardstick, "bare Zenoh", unit="core", bar=bar)


def _heard(name: str, service: str, lived: Lived, bars: Bars) -> Iterator[Row]:
    counters = lived.counters[service]
    sent = sent_to(service, lived.fed, lived.counters)
    total = [float(sum(count for topic, count in sent.items() if topic in counters.heard))]
    poses = sent[Pose.topic]
    poses_missed = missed({Pose.topic: poses}, counters.heard)
    uncounted = max(missed(sent, counters.heard) - counters.dropped, 0)
    title = f"{name}: {service}"
    yield compared(f"{title}, poses missed", [poses_missed], [poses], "poses sent", bar=bars.missed)
    yield compared(f"{title}, counted as lost", [counters.dropped], total, "messages sent")
    yield compared(
        f"{title}, lost and counted nowhere",
        [uncounted],
        total,
        "messages sent",
        bar=bars.uncounted,
    )


def _bare_missed(name: str, bare: Bare) -> Row:
    """Where these miss something too, the machine was too busy for anybody."""
    poses = bare.fed.sent[Pose.topic]
    worst = max(missed({Pose.topic: poses}, heard) for heard in bare.heard.values())
    return compared(
        f"{name}: bare listeners, poses missed at worst", [worst], [poses], "poses sent"
    )


def _memory(name: str, process: str, load: Load, lived: Lived) -> Row:
    """What came on top of the process without a vehicle."""
    growth_kb = lived.fed.memory_bytes[process] / 1e3
    newest_kb = sum(lived.sizes.values()) / 1e3
    title = f"{name}: {process}, memory a vehicle"
    return compared(title, [growth_kb / load.vehicles], [newest_kb], NEWEST, unit="kB")


def _page(name: str, load: Load, lived: Lived) -> Iterator[Row]:
    """A page beside the messages that it is made from."""
    length_s = lived.fed.rounds_ended_s - lived.fed.rounds_began_s
    rates_hz = {topic: load.pose_hz if topic == Pose.topic else 1.0 for topic in lived.sizes}
    a_second = sum(size * rates_hz[topic] for topic, size in lived.sizes.items())
    newest = sum(lived.sizes.values())
    yield compared(
        f"{name}: the page's updates",
        [lived.page_bytes / length_s / 1e3],
        [a_second * load.vehicles / 1e3],
        "messages on the bus",
        unit="kB/s",
    )
    yield compared(
        f"{name}: the page's snapshot",
        [lived.snapshot_bytes / 1e3],
        [newest * load.vehicles / 1e3],
        NEWEST,
        unit="kB",
    )
