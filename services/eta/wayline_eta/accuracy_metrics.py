"""How good predictions were, for Prometheus."""

from collections.abc import Iterable, Iterator

from prometheus_client.core import GaugeMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector

from wayline_eta.accuracy import Accuracy
from wayline_eta.scores import Score, SpanScore

DAYS = 7
OF_SPANS = {
    "count": "Predictions whose arrival has come",
    "mean_s": "Mean of actual minus predicted arrival",
    "mean_absolute_s": "Mean of its absolute value",
    "std_s": "Its standard deviation",
    "benchmark_share": "Share in the ETA Accuracy Benchmark's bounds",
    "cal_itp_share": "Share in Cal-ITP's bounds",
    "held_share": "Share of arrivals within the range from p10 to p90",
}
OF_ROUTES = {
    "arrivals": "Stops that vehicles came to",
    "told_share": "Of the seconds on the route, those with a prediction",
    "ghost_share": "Of the predictions, those of arrivals that never came",
    "mbta_share": "Share in MBTA's bounds",
}


class AccuracyCollector(Collector):
    """Gauges of the newest seven days, by route and by minutes ahead; unknown ones are left out."""

    def __init__(self, accuracy: Accuracy) -> None:
        self._accuracy = accuracy

    def describe(self) -> Iterable[Metric]:
        """Nothing is asked for before the first scrape."""
        return ()

    def collect(self) -> Iterator[Metric]:
        """All of them."""
        scores = self._accuracy.by_route(DAYS)
        for name, meaning in OF_ROUTES.items():
            yield _of_routes(name, meaning, scores)
        for name, meaning in OF_SPANS.items():
            yield _of_spans(name, meaning, scores)


def _of_routes(name: str, meaning: str, scores: dict[str, Score]) -> Metric:
    gauge = GaugeMetricFamily(_named(name), meaning, labels=["route_id"])
    for route_id, score in scores.items():
        if (value := getattr(score, name)) is not None:
            gauge.add_metric([route_id], value)
    return gauge


def _of_spans(name: str, meaning: str, scores: dict[str, Score]) -> Metric:
    gauge = GaugeMetricFamily(_named(name), meaning, labels=["route_id", "minutes"])
    for route_id, score in scores.items():
        for span in score.spans:
            if (value := getattr(span, name)) is not None:
                gauge.add_metric([route_id, _minutes(span)], value)
    return gauge


def _minutes(span: SpanScore) -> str:
    return f"{span.from_min:g}-{span.to_min:g}"


def _named(name: str) -> str:
    return f"wayline_eta_prediction_{name.removesuffix('_s')}" + (
        "_seconds" if name.endswith("_s") else ""
    )
