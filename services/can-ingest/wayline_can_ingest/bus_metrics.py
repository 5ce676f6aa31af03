"""How buses do, for Prometheus."""

from collections.abc import Callable, Iterator, Sequence

from prometheus_client import Metric
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.registry import Collector

from wayline_can_ingest.bus_condition import BusCondition

Conditions = Callable[[], Sequence[tuple[str, BusCondition]]]
"""Source and condition of each bus."""


class BusCollector(Collector):
    """Ages are left out while there are none: what never came has no age."""

    def __init__(self, conditions: Conditions) -> None:
        self._conditions = conditions

    def collect(self) -> Iterator[Metric]:
        """The metrics of now."""
        by_source = ["source"]
        well = GaugeMetricFamily("wayline_can_well", "1 while mapped frames come", labels=by_source)
        frame = GaugeMetricFamily(
            "wayline_can_frame_age_seconds", "Since the last frame", labels=by_source
        )
        mapped = GaugeMetricFamily(
            "wayline_can_mapped_frame_age_seconds", "Since the last mapped one", labels=by_source
        )
        opened = CounterMetricFamily(
            "wayline_can_reconnections", "Interfaces opened anew", labels=by_source
        )
        faults = CounterMetricFamily(
            "wayline_can_faults", "Counted and left out", labels=["source", "reason"]
        )
        for source, condition in self._conditions():
            well.add_metric([source], float(condition.problem is None))
            for family, age_s in ((frame, condition.frame_age_s), (mapped, condition.mapped_age_s)):
                if age_s is not None:
                    family.add_metric([source], age_s)
            opened.add_metric([source], condition.reconnections)
            for reason, times in condition.faults.items():
                faults.add_metric([source, reason], times)
        yield from (well, frame, mapped, opened, faults)
