"""Pure: how good arrivals were, as tables."""

from collections.abc import Iterator

from rich.table import Table

from wayline_eta.scores import SpanScore
from wayline_evaluation.drive_table import drive_table, number, percent
from wayline_evaluation.eta import EtaReport, EtaScore, YardstickScore

COLUMNS = (
    "ahead\nmin",
    "count",
    "mean\ns",
    "absolute\ns",
    "std\ns",
    "Benchmark\n%",
    "Cal-ITP\n%",
    "p10-p90\nholds %",
)
TRIALS_MAX = 40
"""More are in the JSON file only."""


def eta_tables(report: EtaReport) -> Iterator[Table]:
    """By minutes ahead, by MBTA's table, and by stop and trial as papers/000 has it."""
    yield _by_span(report)
    yield _by_mbta(report)
    if report.yardstick is not None:
        yield _beside(report.yardstick, "who knows more (the yardstick)", "yardstick")
    if report.timetable is not None:
        yield _beside(report.timetable, "the timetable itself", "timetable")
    if report.trials:
        yield _by_stop(report)
        yield _by_trial(report)


def _by_span(report: EtaReport) -> Table:
    """A row a drive and span of minutes ahead, then all drives together."""
    table = drive_table("arrivals: when the vehicle came minus when it was said to", COLUMNS)
    for score in (*report.scores, report.pooled):
        for span in score.spans:
            if span.count:
                table.add_row(score.drive, *_cells(span))
        table.add_row(score.drive, *_summary(score), end_section=True)
    return table


def _cells(span: SpanScore) -> tuple[str, ...]:
    return (
        f"{span.from_min:g}-{span.to_min:g}",
        f"{span.count:,}",
        number(span.mean_s, 0),
        number(span.mean_absolute_s, 0),
        number(span.std_s, 0),
        percent(span.benchmark_share),
        percent(span.cal_itp_share),
        percent(span.held_share),
    )


def _by_mbta(report: EtaReport) -> Table:
    """A row a drive: of the predictions that gave so many minutes, those in MBTA's bounds."""
    spans = [f"{span.from_min:g}-{span.to_min:g} min\n%" for span in report.pooled.mbta]
    table = drive_table("in MBTA's bounds, by the minutes that were told", (*spans, "all\n%"))
    for score in (*report.scores, report.pooled):
        shares = [percent(span.share) for span in score.mbta]
        table.add_row(score.drive, *shares, percent(score.mbta_share))
    return table


def _beside(score: YardstickScore, whom: str, short: str) -> Table:
    """A row a span: what was told once a minute beside what somebody else tells of the same."""
    columns = [f"{whose}\n{what}" for whose in ("told", short) for what in COLUMNS[2:5]]
    table = drive_table(f"once a minute, beside {whom}", (*COLUMNS[:2], *columns), ("drive",))
    for told, other in zip(score.told.spans, score.yardstick.spans, strict=True):
        if told.count:
            figures = [
                number(each, 0)
                for span in (told, other)
                for each in (span.mean_s, span.mean_absolute_s, span.std_s)
            ]
            ahead = f"{told.from_min:g}-{told.to_min:g}"
            table.add_row("all", ahead, f"{told.count:,}", *figures)
    return table


def _by_stop(report: EtaReport) -> Table:
    """At each stop, what was then told of the destination, over all laps or trips."""
    title = "at each stop: the arrival at the destination minus the told one (papers/000, table 3)"
    table = drive_table(title, ("count", "mean\ns", "std\ns"), ("route", "stop"))
    for stop in report.stops:
        figures = number(stop.mean_s, 2), number(stop.std_s, 2)
        table.add_row(stop.route_id, stop.stop_id, f"{stop.count:,}", *figures)
    return table


def _by_trial(report: EtaReport) -> Table:
    """On each lap or trip those errors in the order of its stops, and how they are spread."""
    title = "on each lap or trip: those errors, stop by stop (papers/000, tables 2 and 4)"
    table = drive_table(title, ("mean\ns", "std\ns"), ("trial", "errors, s"))
    for trial in report.trials[:TRIALS_MAX]:
        errors = " ".join(number(error_s, 0) for error_s in trial.errors_s)
        table.add_row(trial.trial, errors, number(trial.mean_s, 2), number(trial.std_s, 2))
    return table


def _summary(score: EtaScore) -> tuple[str, ...]:
    told = f"told {percent(score.told_share)} %, ghosts {percent(score.ghost_share)} %"
    return f"{score.arrivals:,} stops", told, "", "", "", percent(score.benchmark_share), "", ""
