"""What of a fleet was missed, what of that was counted, and the bars on it."""

from collections import Counter

import pytest

from wayline_bench.fleet_figures import PROCESSES, Bare, Counters, Fed, Lived, Load, Quiet
from wayline_bench.fleet_rows import Bars, fleet_rows, missed, sent_to, silent_rows
from wayline_bench.row import Row

LOAD = Load(vehicles=10, pose_hz=1.0, rounds=2, round_s=4.0)
SIZES = {"pose": 400, "progress": 200, "horizon": 1000}
BARS = Bars(router=2.0, missed=0.001, uncounted=0.0)


def fed(core: float) -> Fed:
    return Fed(
        sent=Counter(pose=1000, health=2000),
        core_shares=[dict.fromkeys(PROCESSES, core)] * 2,
        memory_bytes=dict.fromkeys(PROCESSES, 160_000),
        rounds_began_s=100.0,
        rounds_ended_s=108.0,
    )


def rows(heard_by_eta: int = 1000, dropped: int = 0, horizons: int = 900) -> dict[str, Row]:
    counters = {
        "eta": Counters({"pose": heard_by_eta}, {"progress": 950}, dropped),
        "slope-map": Counters({"pose": 1000}, {"horizon": 900}, 0),
        "dashboard": Counters({"pose": 1000, "progress": 950, "horizon": horizons}, {}, 0),
    }
    lived = Lived(fed(0.3), counters, page_bytes=64_000, snapshot_bytes=8_000, sizes=SIZES)
    table = fleet_rows(
        LOAD, lived, Bare(fed(0.1), {"eta": {"pose": 990}, "dashboard": {"pose": 1000}}), BARS
    )
    return {row.what.removeprefix("10 at 1 Hz: "): row for row in table}


def test_cpu_stands_beside_the_bare_load() -> None:
    router = rows()["router, CPU"]
    assert router.ratio == pytest.approx(3.0)
    assert not router.holds
    assert rows()["eta, CPU"].bar is None


def test_all_heard_holds() -> None:
    held = rows()
    for service in ("eta", "slope-map", "dashboard"):
        assert held[f"{service}, poses missed"].holds
        assert held[f"{service}, lost and counted nowhere"].holds


def test_what_was_missed_must_be_little_and_counted() -> None:
    one = rows(heard_by_eta=999, dropped=1)
    assert one["eta, poses missed"].holds
    assert one["eta, counted as lost"].ours == 1.0
    assert one["eta, lost and counted nowhere"].holds
    two = rows(heard_by_eta=998, dropped=1)
    assert not two["eta, poses missed"].holds
    assert two["eta, lost and counted nowhere"].ours == 1.0
    assert not two["eta, lost and counted nowhere"].holds


def test_what_services_say_to_each_other_is_not_lost_unseen_either() -> None:
    row = rows(horizons=897)["dashboard, lost and counted nowhere"]
    assert (row.ours, row.yardstick) == (3.0, 1000 + 950 + 900)


def test_a_topic_that_nobody_reads_and_one_heard_twice_are_not_missed() -> None:
    assert missed({"pose": 10, "gps_fix": 10}, {"pose": 12}) == 0
    assert "health" not in sent_to("eta", fed(0.1), {})


def test_a_machine_too_busy_for_anybody_shows() -> None:
    assert rows()["bare listeners, poses missed at worst"].ours == 10.0


def test_memory_and_page_are_told_beside_the_messages() -> None:
    held = rows()
    assert (held["eta, memory a vehicle"].ours, held["eta, memory a vehicle"].ratio) == (16.0, 10.0)
    assert (held["the page's updates"].ours, held["the page's updates"].ratio) == (8.0, 0.5)
    assert held["the page's snapshot"].ratio == 0.5


def test_a_silent_fleet_may_cost_nothing_that_can_be_measured() -> None:
    before = Quiet({"router": 0.001, "eta": 0.004}, 3.6)
    quiet = silent_rows(750, before, Quiet({"router": 0.002, "eta": 0.005}, 3.7))
    busy = silent_rows(750, before, Quiet({"router": 0.9, "eta": 0.005}, 1500.0))
    assert all(row.holds for row in quiet)
    assert [row.holds for row in busy] == [False, True, False]
