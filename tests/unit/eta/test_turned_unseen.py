"""A vehicle that reports once a minute and turns round at its last stop between two reports."""

from pathlib import Path

import pytest

from unit.eta.rides import BERLIN, DAY, NORTH_M
from unit.timetable.faulty_feeds import LAT_DEG, LON_DEG, good_feed, write_folder
from wayline.inputs import Tick
from wayline.messages import GpsFix, Message, Progress, StopEvent
from wayline.timetable.calendar import SECOND_NS, instant_ns
from wayline.timetable.reading import read_timetable
from wayline.timetable.runs import Runs
from wayline.tuning import Tuning
from wayline_eta.timetable_core import timetable_node

END_M, SPEED_MPS = 4_002.9, 8.34


def there_and_back(folder: Path, block_id: str) -> Runs:
    """T to the north at eight, back to the south at 08:10."""
    tables = good_feed()
    tables["trips.txt"] = (
        "route_id,service_id,trip_id,direction_id,block_id,shape_id\n"
        f"R,S,T,0,{block_id},SH\nR,S,back,1,{block_id},\n"
    )
    rows = [row for row in tables["stop_times.txt"].splitlines() if not row.startswith("U")]
    rows += [f"back,08:{10 + 2 * at}:00,08:{10 + 2 * at}:00,S{4 - at},{at + 1}" for at in range(5)]
    tables["stop_times.txt"] = "\n".join(rows) + "\n"
    return Runs([read_timetable(write_folder(tables, folder))])


def drive(runs: Runs, *, turned_m: float, headed: bool) -> list[Message]:
    """To `turned_m` and back, told of once a minute while it drives; a minute's stand between."""
    node = timetable_node(runs, Tuning(), None)
    told: list[Message] = []
    begins_ns = instant_ns(DAY, 8 * 3600.0, BERLIN)
    turns_s = turned_m / SPEED_MPS
    for second in range(round(turns_s) + 60 + 300):
        back_m = max(second - turns_s - 60.0, 0.0) * SPEED_MPS
        north_m = min(SPEED_MPS * second, turned_m) - back_m
        t_ns = begins_ns + second * SECOND_NS
        stands = second > turns_s and back_m == 0.0
        if second % 60 == 20 and not stands:
            fix = GpsFix(
                t_ns=t_ns,
                valid=True,
                lat_deg=LAT_DEG + north_m / NORTH_M,
                lon_deg=LON_DEG,
                course_deg=(180.0 if back_m else 0.0) if headed else None,
                speed_mps=SPEED_MPS if headed else None,
            )
            told += node.take(fix, "gps-ingest")
        told += node.give(Tick(t_ns), "eta")
    return told


@pytest.mark.parametrize("headed", [True, False])
@pytest.mark.parametrize("block_id", ["B", ""])
def test_the_way_back_is_known_by_the_first_report_on_it(
    tmp_path: Path, block_id: str, headed: bool
) -> None:
    told = drive(there_and_back(tmp_path, block_id), turned_m=END_M, headed=headed)
    progress = [each for each in told if isinstance(each, Progress)]
    begins_ns = instant_ns(DAY, 8 * 3600.0, BERLIN)
    by_second = {(each.t_ns - begins_ns) // SECOND_NS: each for each in progress}
    # seen 330 m before its last stop, then 170 m and 670 m behind it; without a heading that first
    # one might be on the way there
    assert by_second[559].trip_id == "T"
    back = [by_second[second] for second in range(561 if headed else 621, 840)]
    assert {each.trip_id for each in back} == {"back"}
    assert {each.direction_id for each in back} == {1}
    came = [each for each in told if isinstance(each, StopEvent) and each.trip_id == "T"]
    assert [each.stop_sequence for each in came if each.kind == "arrived"][-1] == 5


def test_a_vehicle_that_turns_long_before_its_last_stop_has_not_served_it(tmp_path: Path) -> None:
    told = drive(there_and_back(tmp_path, "B"), turned_m=END_M - 1_500.0, headed=True)
    events = [each for each in told if isinstance(each, StopEvent) and each.trip_id == "T"]
    assert "arrived" not in {each.kind for each in events if each.stop_sequence == 5}
