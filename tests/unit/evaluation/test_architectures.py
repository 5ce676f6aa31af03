"""Architectures side by side: how errors grow in an outage, and what stands in the table."""

import dataclasses

import numpy as np
import pytest
from rich.console import Console

from unit.evaluation.drives import START_S, eastwards, off
from wayline.errors import InputError
from wayline_evaluation.architectures import PAPER_PCT, architecture_rows, paper_rows
from wayline_evaluation.estimates import Floats
from wayline_evaluation.growth import Drift, Growth, drift_of, growths
from wayline_evaluation.outage_study import architectures_of
from wayline_evaluation.outages import OutageScore, outage_report
from wayline_evaluation.reference import Reference
from wayline_evaluation.tables import architecture_tables
from wayline_replay.outages import Outage

OUTAGE = Outage(20.0, 60.0)


def drift(
    truth: Reference, *, metres_per_s: float, name: str = "loose", length_s: float = 60.0
) -> Drift:
    """Of a filter that strays to the right at a steady rate."""
    since_s = np.maximum(truth.times_s - START_S - OUTAGE.start_s, 0.0)
    return drift_of(
        OUTAGE._replace(length_s=length_s),
        name=name,
        drive_start_s=START_S,
        estimates=off(truth, right_m=metres_per_s * since_s),
        reference=truth,
    )


def stopping(truth: Reference, after_s: float) -> Reference:
    """The same times, but the vehicle stands from then on."""
    distances_m = np.minimum(truth.distances_m, 10.0 * after_s)
    return dataclasses.replace(truth, distances_m=distances_m)


def grown(*drifts: Drift) -> Growth:
    (growth,) = growths(drifts)
    return growth


def score(architecture: str, duration_s: float, cross_track_m: float) -> OutageScore:
    return OutageScore(
        drive="a",
        filter=architecture,
        pass_number=1,
        start_s=0.0,
        duration_s=duration_s,
        distance_m=1000.0,
        cross_track_m=cross_track_m,
        along_track_m=0.0,
        horizontal_m=abs(cross_track_m),
        heading_deg=None,
        horizontal_pct=0.1 * abs(cross_track_m),
        cross_track_pct=0.1 * abs(cross_track_m),
    )


def test_errors_grow_from_the_beginning_of_the_outage() -> None:
    """0.1 m a second at 10 m/s: 1 m after 10 s, and after 100 m."""
    growth = grown(drift(eastwards(), metres_per_s=0.1))
    assert growth.times_s[:2] == (0.0, 1.0)
    assert growth.p50_m[10] == pytest.approx(1.0, abs=1e-3)
    assert dict(zip(growth.distances_m, growth.over_distance_p50_m, strict=True))[
        100.0
    ] == pytest.approx(1.0, abs=1e-3)
    assert growth.distances_m[-1] == 580.0


def test_quantiles_are_over_the_outages() -> None:
    truth = eastwards()
    growth = grown(*(drift(truth, metres_per_s=rate) for rate in (0.1, 0.2, 0.6)))
    assert growth.count == 3
    assert growth.p50_m[50] == pytest.approx(10.0, abs=1e-2)
    assert growth.p90_m[50] == pytest.approx(26.0, abs=1e-2)


def test_architectures_and_durations_are_not_pooled() -> None:
    truth = eastwards()
    found = list(
        growths(
            [
                drift(truth, metres_per_s=0.1),
                drift(truth, metres_per_s=0.5, name="uncoupled"),
                drift(truth, metres_per_s=0.1, length_s=30.0),
            ]
        )
    )
    assert [(growth.filter, growth.duration_s) for growth in found] == [
        ("loose", 60.0),
        ("uncoupled", 60.0),
        ("loose", 30.0),
    ]


def test_where_a_vehicle_stood_the_error_is_that_with_which_it_went_on() -> None:
    """Errors go on growing at rest; over the way that is one step."""
    truth = eastwards()
    resting = truth.distances_m.copy()
    rest = slice(400, 600)
    resting[rest] = resting[400]
    resting[600:] -= resting[600] - resting[400]
    growth = grown(drift(dataclasses.replace(truth, distances_m=resting), metres_per_s=0.1))
    over = dict(zip(growth.distances_m, growth.over_distance_p50_m, strict=True))
    assert over[180.0] == pytest.approx(1.8, abs=1e-2)
    assert over[200.0] == pytest.approx(4.0, abs=1e-2)


def test_over_the_way_the_curve_ends_where_too_few_came() -> None:
    """Of three outages only one went on: it alone would tell of the fastest drive."""
    truth = eastwards()
    short = stopping(truth, 41.0)
    growth = grown(*(drift(each, metres_per_s=0.1) for each in (truth, short, short)))
    assert growth.distances_m[-1] == 200.0
    assert len(growth.times_s) == 60


def test_instants_that_nothing_describes_are_left_out() -> None:
    """Of two drives one ends in the outage: the other goes on alone."""
    short, long = (drift(eastwards(seconds), metres_per_s=0.1) for seconds in (50.0, 70.0))
    assert grown(short).times_s[-1] == 30.0
    growth = grown(short, long)
    assert growth.times_s[-1] == 50.0
    assert growth.p50_m[50] == pytest.approx(5.0, abs=1e-2)


def test_papers_001_is_what_its_abstract_says() -> None:
    """5.3 % of the distance on the average of its four outages."""
    rows = paper_rows()
    assert [(row.duration_s, row.count) for row in rows] == [(100.0, 3), (200.0, 1)]
    shares_pct = [row.cross_track_pct or 0.0 for row in rows for _ in range(row.count)]
    assert np.mean(shares_pct) == pytest.approx(PAPER_PCT, abs=0.06)


def test_the_table_has_a_row_an_architecture_and_the_papers_own() -> None:
    """Means of cross-track errors are of their absolute values."""
    scores = [
        score("loose", 60.0, 10.0),
        score("loose", 60.0, -20.0),
        score("uncoupled", 60.0, 400.0),
    ]
    rows = architecture_rows(scores)
    assert [(row.architecture, row.count) for row in rows] == [("loose", 2), ("uncoupled", 1)]
    assert rows[0].cross_track_m == pytest.approx(15.0)
    assert rows[0].cross_track_pct == pytest.approx(1.5)
    console = Console(width=120)
    with console.capture() as capture:
        for table in architecture_tables(outage_report("truth", scores, 0)):
            console.print(table)
    lines = capture.get().splitlines()
    assert [line.split()[0] for line in lines[-4:]] == [
        "loose",
        "uncoupled",
        "papers/001",
        "papers/001",
    ]


def test_architectures_are_named_with_commas() -> None:
    assert architectures_of("loose, gps_only") == ("loose", "gps_only")


def test_an_unknown_architecture_is_one_line_with_the_names() -> None:
    with pytest.raises(InputError, match=r"'tight' is not known; give some of loose, measurement"):
        architectures_of("loose,tight")


def test_errors_of_no_known_distance_are_no_curve() -> None:
    """A drive without positions in the reference still has its errors over time."""
    truth = eastwards()
    unknown: Floats = np.full(len(truth.times_s), np.nan)
    growth = grown(drift(dataclasses.replace(truth, distances_m=unknown), metres_per_s=0.1))
    assert growth.distances_m == ()
    assert len(growth.times_s) == 60
