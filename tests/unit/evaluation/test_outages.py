import dataclasses

import msgspec
import numpy as np
import pytest

from builders import at
from unit.evaluation.drives import START_S, eastwards, off
from wayline.messages import GpsFix, GpsRaw, RawSatellite
from wayline.received import Received
from wayline_evaluation.estimates import Estimates
from wayline_evaluation.outages import OutageScore, outage_report, schedule, score_outage
from wayline_evaluation.reference import Reference, fixes_reference
from wayline_replay.outages import Outage, with_outages


def drifting(truth: Reference, begin_s: float) -> Estimates:
    """Off to the right by 0.1 m for every second since the outage began."""
    since_s = np.maximum(truth.times_s - START_S - begin_s, 0.0)
    return off(truth, right_m=0.1 * since_s, heading_deg=1.0, dead_from_s=begin_s)


def scored(reference: Reference, estimates: Estimates, outage: Outage) -> OutageScore | None:
    return score_outage(
        outage,
        drive="a",
        name="fusion",
        pass_number=1,
        drive_start_s=START_S,
        estimates=estimates,
        reference=reference,
    )


def test_an_outage_is_scored_at_its_last_pose() -> None:
    """59.9 s after its beginning, when 60 s of drift are nearly there; in percent of 599 m."""
    truth = eastwards()
    score = scored(truth, drifting(truth, 20.0), Outage(20.0, 60.0))
    assert score is not None
    assert score.cross_track_m == pytest.approx(5.99, abs=1e-3)
    assert score.along_track_m == pytest.approx(0.0, abs=1e-3)
    assert score.distance_m == pytest.approx(599.0, abs=0.01)
    assert score.horizontal_pct == pytest.approx(1.0, abs=1e-3)
    assert score.heading_deg == pytest.approx(1.0)


def test_without_a_truth_it_is_scored_at_its_last_recorded_fix() -> None:
    """Fixes once a second: the last one is 59 s after the beginning."""
    truth = eastwards()
    rows = range(0, len(truth.times_s), 10)
    fixes = [
        GpsFix(
            t_ns=round(truth.times_s[row] * 1e9),
            valid=True,
            lat_deg=float(truth.lats_deg[row]),
            lon_deg=float(truth.lons_deg[row]),
        )
        for row in rows
    ]
    reference = fixes_reference(fixes, off(truth))
    score = scored(reference, drifting(truth, 20.0), Outage(20.0, 60.0))
    assert score is not None
    assert score.cross_track_m == pytest.approx(5.9, abs=1e-3)
    assert score.heading_deg is None


def test_an_outage_that_nothing_describes_is_left_out() -> None:
    """It is counted as skipped, not as perfect."""
    truth = eastwards()
    assert scored(truth, drifting(truth, 20.0), Outage(200.0, 60.0)) is None


def test_a_vehicle_that_stands_has_no_percentage() -> None:
    """Nothing was driven that the error could be a share of."""
    truth = eastwards()
    parked = dataclasses.replace(truth, distances_m=np.zeros(len(truth.times_s)))
    score = scored(parked, drifting(truth, 20.0), Outage(20.0, 60.0))
    assert score is not None
    assert score.horizontal_pct is None


def test_each_pass_begins_later() -> None:
    """Three passes of outages every 180 s begin 60 s apart, and every outage ends in the drive."""
    passes = schedule(length_s=60.0, every_s=180.0, start_s=240.0, passes=3, until_s=700.0)
    assert [[outage.start_s for outage in each] for each in passes] == [
        [240.0, 420.0, 600.0],
        [300.0, 480.0],
        [360.0, 540.0],
    ]


def test_the_report_sums_up_by_filter_and_duration() -> None:
    """Quantiles are over outages; the ratio is fusion over yardstick."""
    truth = eastwards()
    score = scored(truth, drifting(truth, 20.0), Outage(20.0, 60.0))
    assert score is not None
    possible = msgspec.structs.replace(score, filter="yardstick", horizontal_m=2.0)
    report = outage_report("truth", [score, possible, score], 1)
    assert [(each.filter, each.count) for each in report.summaries] == [
        ("fusion", 2),
        ("yardstick", 1),
    ]
    assert report.ratios["60"].p50 == pytest.approx(3.0, abs=0.01)
    assert report.skipped == 1


def test_an_outage_leaves_the_same_few_satellites_to_those_who_read_them() -> None:
    """By system and number, so that it is the same ones all the time."""
    seen = [("glonass", 1), ("gps", 21), ("gps", 4), ("galileo", 2), ("gps", 7)]
    satellites = tuple(RawSatellite(system=system, prn=prn) for system, prn in seen)
    messages = [
        Received(at(seconds), 0, "gps-ingest", GpsRaw(t_ns=at(seconds), satellites=satellites))
        for seconds in range(4)
    ]
    told = [each.message for each in with_outages(messages, [Outage(1.0, 2.0, 2)])]
    kept = [[each.prn for each in epoch.satellites] for epoch in told if isinstance(epoch, GpsRaw)]
    assert kept == [[1, 21, 4, 2, 7], [4, 7], [4, 7], [1, 21, 4, 2, 7]]
