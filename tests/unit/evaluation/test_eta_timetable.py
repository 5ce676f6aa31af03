"""What was told beside what the timetable says of the same arrivals."""

import msgspec

from unit.eta.route_drives import SECOND_NS, START_NS
from wayline.messages import Arrivals, StopArrival
from wayline_evaluation.eta_timetable import promised

MINUTE_NS = START_NS - START_NS % (60 * SECOND_NS)


def told(t_ns: int, scheduled_s: float | None) -> Arrivals:
    planned_ns = None if scheduled_s is None else t_ns + round(scheduled_s * SECOND_NS)
    stops = [
        StopArrival(
            stop_id=stop_id,
            name=stop_id,
            distance_m=0.0,
            arrival_ns=t_ns + 100 * SECOND_NS,
            early_ns=t_ns + 90 * SECOND_NS,
            late_ns=t_ns + 120 * SECOND_NS,
            scheduled_ns=scheduled_ns,
        )
        for stop_id, scheduled_ns in (("a", planned_ns), ("b", None))
    ]
    return Arrivals(t_ns=t_ns, route_id="r", stale=False, stops=tuple(stops))


def test_once_a_minute_the_timetable_stands_in_for_what_was_told() -> None:
    """Of the stops that it has a time for, and of those alone."""
    every = [told(MINUTE_NS + second * SECOND_NS, 40.0) for second in range(61)]
    pair = promised(every)
    assert pair is not None
    assert [each.t_ns for each in pair.told] == [MINUTE_NS, MINUTE_NS + 60 * SECOND_NS]
    [stop], [planned] = pair.told[0].stops, pair.yardstick[0].stops
    assert (stop.stop_id, stop.arrival_ns) == ("a", MINUTE_NS + 100 * SECOND_NS)
    assert planned.arrival_ns == planned.early_ns == MINUTE_NS + 40 * SECOND_NS


def test_what_is_stale_or_has_no_timetable_is_not_compared() -> None:
    assert promised([told(MINUTE_NS, None)]) is None
    assert promised([msgspec.structs.replace(told(MINUTE_NS, 40.0), stale=True)]) is None
