"""Times ahead are refused, but for the sake of its own clock nobody refuses everything."""

from wayline.ahead import AHEAD_NS, Ahead
from wayline.messages import GpsFix, Pose

HOUR_NS = 3_600_000_000_000


def refused(ahead: Ahead, times: list[tuple[float, int]]) -> list[bool]:
    return [ahead.refuses(Pose, ahead_ns, now_s) for now_s, ahead_ns in times]


def test_what_is_a_minute_ahead_is_taken_and_what_is_more_is_refused() -> None:
    assert refused(Ahead(), [(0.0, -HOUR_NS), (0.1, AHEAD_NS), (0.2, AHEAD_NS + 1)]) == [
        False,
        False,
        True,
    ]


def test_as_long_as_anybody_is_on_time_what_is_ahead_is_refused() -> None:
    times = [(tenth / 10, HOUR_NS if tenth % 20 else 0) for tenth in range(1_000)]
    assert refused(Ahead(), times) == [ahead_ns > 0 for _, ahead_ns in times]


def test_the_hosts_clock_is_overruled_when_nobody_else_has_its_time() -> None:
    found = refused(Ahead(), [(float(second), HOUR_NS) for second in range(20)])
    assert found == [True] * 10 + [False] * 10


def test_a_few_messages_overrule_nobody_however_long_they_take() -> None:
    assert all(refused(Ahead(), [(60.0 * minute, HOUR_NS) for minute in range(10)]))


def test_clocks_of_other_topics_do_not_speak_for_the_hosts() -> None:
    """What a CAN bus is stamped with is the host's own clock, wrong as it may be."""
    ahead = Ahead()
    for tenth in range(200):
        ahead.refuses(Pose, 0, tenth / 10)
        is_refused = ahead.refuses(GpsFix, HOUR_NS, tenth / 10)
    assert not is_refused
