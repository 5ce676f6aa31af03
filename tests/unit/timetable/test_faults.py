"""Every fault of the corpus alone and with every other one: the feed is read, and it is said."""

import itertools
from pathlib import Path

import pytest

from unit.timetable.faulty_feeds import FAULTS, Fault, good_feed, write_folder, write_zip
from wayline.timetable.notes import Notes
from wayline_cli.route_import import Wishes, import_route


def test_a_good_feed_needs_no_word(tmp_path: Path) -> None:
    notes = Notes()
    route = import_route(write_folder(good_feed(), tmp_path), Wishes(trip="T"), notes)
    assert notes.all() == ()
    assert [stop.stop_id for stop in route.stops] == ["S0", "S1", "S2", "S3", "S4"]
    assert route.length_m == pytest.approx(4003.0, abs=1.0)


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
@pytest.mark.parametrize("packed", [False, True], ids=["folder", "zip"])
def test_a_fault_is_mended_and_said(fault: Fault, *, packed: bool, tmp_path: Path) -> None:
    """No time is lost: the last stop is reached when the feed says."""
    check((fault,), tmp_path, packed=packed)


@pytest.mark.parametrize(
    "faults",
    list(itertools.combinations(FAULTS, 2)),
    ids=lambda pair: "+".join(one.name for one in pair),
)
def test_two_faults_are_mended_and_said(faults: tuple[Fault, ...], tmp_path: Path) -> None:
    check(faults, tmp_path, packed=True)


HIDES = {
    ("no_shape", "far"), ("no_shape", "swapped"), ("swapped", "no_stop"), ("fast", "no_stop"),
    ("slow", "nowhere"), ("doubled", "no_order"), ("swapped", "fast"), ("swapped", "back"),
    ("back", "nowhere"), ("untimed", "back"), ("fast", "nowhere"), ("no_stop", "nowhere"),
}  # fmt: skip
"""Pairs of which one leaves nothing to say of the other, as without a shape no stop is far from it,
or changes what the plan of the trip is."""


def check(faults: tuple[Fault, ...], folder: Path, *, packed: bool) -> None:
    tables = good_feed()
    for fault in faults:
        fault.put(tables)
    source = write_zip(tables, folder / "feed.zip") if packed else write_folder(tables, folder)
    notes = Notes()
    route = import_route(source, Wishes(trip="T"), notes)
    said = [note.fault for note in notes.all()]
    if tuple(fault.name for fault in faults) not in HIDES:
        for fault in faults:
            assert not fault.says or any(fault.says in each for each in said), said
        longer_s = sum(fault.planned_s - 480.0 for fault in faults)
        planned_s = route.time_at(route.stop_distances_m[-1:])[0]
        planned_s -= route.time_at(route.stop_distances_m[:1])[0]
        assert planned_s + route.stop_dwells_s[:-1].sum() == pytest.approx(480.0 + longer_s, abs=5)
    assert len(route.stops) >= 3
    assert 2_000.0 < route.length_m < 8_000.0
