"""How receivers do, for Prometheus."""

from collections.abc import Callable, Iterator, Sequence

from prometheus_client import Metric
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.registry import Collector

from wayline_gps_ingest.condition import Condition

Conditions = Callable[[], Sequence[tuple[str, Condition]]]
"""Source and condition of each receiver."""


class ReceiverCollector(Collector):
    """Ages are left out while there are none: what never came has no age."""

    def __init__(self, conditions: Conditions) -> None:
        self._conditions = conditions

    def collect(self) -> Iterator[Metric]:
        """The metrics of now."""
        well = GaugeMetricFamily("wayline_receiver_well", "1 while fixes come", labels=["source"])
        sentence = GaugeMetricFamily(
            "wayline_receiver_sentence_age_seconds", "Since the last sentence", labels=["source"]
        )
        fix = GaugeMetricFamily(
            "wayline_receiver_fix_age_seconds", "Since the last valid fix", labels=["source"]
        )
        reconnections = CounterMetricFamily(
            "wayline_receiver_reconnections", "Links opened anew", labels=["source"]
        )
        for source, condition in self._conditions():
            well.add_metric([source], float(condition.problem is None))
            if condition.sentence_age_s is not None:
                sentence.add_metric([source], condition.sentence_age_s)
            if condition.fix_age_s is not None:
                fix.add_metric([source], condition.fix_age_s)
            reconnections.add_metric([source], condition.reconnections)
        yield from (well, sentence, fix, reconnections)
