"""What one vehicle's forecaster adds to what is known of its route."""

import pytest

from unit.eta.route_drives import SECOND_NS, START_NS, Metres, route_of
from wayline.messages import StopArrival
from wayline_eta.forecaster import Forecaster
from wayline_eta.lessons import Lessons, lessons_by
from wayline_eta.records import Learned, Taken

LINE: list[Metres] = [(0, 0), (3000, 0)]
ROUTE = route_of(LINE, stops_m=[0.0, 1000.0, 2000.0])


def forecaster(lessons: Lessons) -> Forecaster:
    return Forecaster(ROUTE, lessons, scope="r", plan="r", sequences=[1, 2, 3])


def comes(seconds: float, wide_s: float) -> StopArrival:
    """At the end of the trip before."""
    arrival_ns = START_NS + round(seconds * SECOND_NS)
    wide_ns = round(wide_s * SECOND_NS)
    return StopArrival(
        stop_id="end",
        name="End",
        distance_m=500.0,
        arrival_ns=arrival_ns,
        early_ns=arrival_ns - wide_ns,
        late_ns=arrival_ns + wide_ns,
    )


def test_the_next_trip_begins_as_late_as_others_do_or_when_its_vehicle_comes() -> None:
    """Twenty left their first stop half a minute late."""
    lessons = lessons_by(())
    for run in range(20):
        taken = Taken(START_NS - run, None, "r", 0.0, 0.0, "r|s0|waits", 30.0)
        lessons.learn(Learned(taken=taken))
    departs_ns = START_NS + 600 * SECOND_NS
    in_time = forecaster(lessons).begins(comes(200.0, 60.0), departs_ns, START_NS)
    assert in_time.left_s == pytest.approx(628.0, abs=1.0)
    late = forecaster(lessons).begins(comes(900.0, 100.0), departs_ns, START_NS)
    assert late.left_s == pytest.approx(900.0, abs=2.0)
    assert late.late_s - late.left_s == pytest.approx(100.0, abs=5.0)
    unsure = forecaster(lessons).begins(comes(620.0, 100.0), departs_ns, START_NS)
    assert unsure.left_s > 650.0, "the later of two"
