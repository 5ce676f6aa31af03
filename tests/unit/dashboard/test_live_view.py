from dataclasses import dataclass

import pytest

from wayline.messages import Message, Pose
from wayline.query_error import QueryError
from wayline.rfc3339 import rfc3339
from wayline.view import Receipt, View
from wayline_dashboard.fleet import Cursor
from wayline_dashboard.live_view import LiveView

START_NS = 1_700_000_000_000_000_000
SECOND_NS = 1_000_000_000
HOUR_NS = 3600 * SECOND_NS


@dataclass
class Host:
    """A host whose wall clock can be set without its monotonic clock going along."""

    wall_ns: int = START_NS
    monotonic_ns: int = 0

    def pass_time(self, seconds: float) -> None:
        self.wall_ns += round(seconds * SECOND_NS)
        self.monotonic_ns += round(seconds * SECOND_NS)

    def live(self) -> LiveView:
        return LiveView(lambda: self.monotonic_ns, lambda: self.wall_ns)


def pose(t_ns: int) -> Pose:
    return Pose(t_ns=t_ns, mode="gps", lat_deg=39.9, lon_deg=-75.35)


def heard_and_now(live: LiveView) -> tuple[str | None, str]:
    view = live.snapshot()
    return view.vehicles[0].heard, view.now


def test_it_is_a_view_of_what_the_page_shows() -> None:
    view: View = LiveView()
    assert Pose in view.reads
    assert Message not in view.reads


def test_a_pose_that_came_an_hour_old_is_an_hour_old() -> None:
    host = Host()
    live = host.live()
    live.put("alpha", pose(START_NS - HOUR_NS), "fusion", Receipt(0, age_ns=HOUR_NS))
    host.pass_time(2.0)
    assert heard_and_now(live) == (rfc3339(START_NS - HOUR_NS), rfc3339(START_NS + 2 * SECOND_NS))


def test_a_recording_ages_from_its_receipt() -> None:
    host = Host()
    live = host.live()
    live.put("alpha", pose(0), "fusion", Receipt(0))
    host.pass_time(2.0)
    assert heard_and_now(live) == (rfc3339(START_NS), rfc3339(START_NS + 2 * SECOND_NS))


@pytest.mark.parametrize("step_s", [3600, -3600])
def test_a_step_of_the_wall_clock_changes_no_age(step_s: int) -> None:
    host = Host()
    live, cursor = host.live(), Cursor()
    live.put("alpha", pose(START_NS), "fusion", Receipt(0))
    live.read(cursor)
    host.pass_time(7.0)
    host.wall_ns += step_s * SECOND_NS
    assert heard_and_now(live) == (rfc3339(host.wall_ns - 7 * SECOND_NS), rfc3339(host.wall_ns))
    assert live.heartbeat(cursor).now == rfc3339(host.wall_ns)


def test_a_forgotten_vehicle_cannot_be_selected_until_it_is_heard_again() -> None:
    live = LiveView()
    live.put("alpha", pose(START_NS), "fusion", Receipt(0))
    live.forget("alpha")
    assert live.snapshot().vehicles == ()
    with pytest.raises(QueryError, match="no vehicle alpha was heard"):
        live.snapshot("alpha")
    live.put("alpha", pose(START_NS), "fusion", Receipt(0))
    assert live.snapshot("alpha").selected == "alpha"
