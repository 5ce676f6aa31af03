"""Fixes that are withheld, and how a study scores what is left."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from builders import fix, odometer
from wayline.errors import InputError
from wayline.messages import GpsFix, Message
from wayline.received import Received
from wayline_cli.__main__ import app
from wayline_evaluation.replays import Options
from wayline_evaluation.sparse_study import sparse_study
from wayline_evaluation.sparse_table import sparse_table
from wayline_replay.withheld import Withheld, withheld_of, without


def received(*messages: Message) -> list[Received]:
    return [Received(each.t_ns, 0, "gps-ingest", each) for each in messages]


def left(messages: list[Received], withheld: Withheld) -> list[Message]:
    return [each.message for each in without(messages, withheld)]


def test_only_each_fifth_fix_is_left_and_all_that_the_vehicle_tells() -> None:
    fixes = [fix(float(second), 57.0, 10.0) for second in range(11)]
    wheels = [odometer(float(second), 5.0) for second in range(11)]
    found = left(received(*fixes, *wheels), Withheld(fixes_every_s=5.0))
    assert [each for each in found if isinstance(each, GpsFix)] == [fixes[0], fixes[5], fixes[10]]
    assert found[3:] == wheels


def test_an_empty_epoch_does_not_count_as_a_report() -> None:
    """The next good one is told, and the interval begins with it."""
    empty = GpsFix(t_ns=fix(5.0, 57.0, 10.0).t_ns, valid=False)
    fixes = [fix(0.0, 57.0, 10.0), empty, fix(6.0, 57.0, 10.0), fix(10.0, 57.0, 10.0)]
    assert left(received(*fixes), Withheld(fixes_every_s=5.0)) == fixes[:3]


def test_parts_of_fixes_and_of_the_vehicle_are_withheld_by_name() -> None:
    told = fix(0.0, 57.0, 10.0, speed_mps=5.0, course_deg=90.0)
    (blind,) = left(received(told, odometer(0.0, 5.0)), withheld_of("can, course"))
    assert isinstance(blind, GpsFix)
    assert (blind.speed_mps, blind.course_deg) == (5.0, None)
    (slow,) = left(received(told), withheld_of("speed"))
    assert isinstance(slow, GpsFix)
    assert (slow.speed_mps, slow.course_deg) == (None, None)


def test_what_cannot_be_withheld_is_named() -> None:
    with pytest.raises(InputError, match="'clock' cannot be withheld"):
        withheld_of("gyro,clock")


def test_a_drive_is_scored_at_seldom_fixes_and_before_the_next(tmp_path: Path) -> None:
    """From the drive's files to the table; more seldom is worse before the next fix."""
    drive = tmp_path / "drive"
    made = CliRunner().invoke(
        app, ["simulate", "--road", "main", "--length-m", "6000", "--out", str(drive)]
    )
    assert made.exit_code == 0, made.output
    options = Options(withheld=withheld_of("can"))
    report, runs = sparse_study([drive], (5.0, 30.0), options, lambda *_: None)
    often, seldom = report.scores
    assert (often.drive, often.reference, often.every_s) == ("drive", "truth", 5.0)
    assert often.fixes > 4 * seldom.fixes
    assert often.accepted_share is not None
    assert often.accepted_share >= 0.97
    assert often.before_next_m is not None
    assert seldom.before_next_m is not None
    assert often.before_next_m.p95 < seldom.before_next_m.p50
    assert seldom.straight_on_m is not None
    assert seldom.before_next_m.p50 < 1.2 * seldom.straight_on_m.p50
    assert len(runs) == 2
    assert sparse_table(report).row_count == 2
