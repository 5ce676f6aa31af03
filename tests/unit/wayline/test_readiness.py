"""What is missing, and since when."""

from builders import at
from wayline.readiness import Hearing, Lack, Readiness

ROUTER = Lack("router", "the bus is gone")


def test_since_when_something_is_missing_is_kept_until_it_is_back() -> None:
    readiness = Readiness()
    readiness.note([ROUTER], 10.0)
    readiness.note([Lack("router", "still gone"), Lack("input", "nothing")], 14.0)
    found = {each.subject: each for each in readiness.missing(15.0, at(100))}
    assert (found["router"].what, found["router"].since_ns) == ("still gone", at(95))
    assert found["input"].since_ns == at(99)
    readiness.note([], 16.0)
    assert readiness.missing(16.0, at(101)) == ()
    readiness.note([ROUTER], 20.0)
    assert readiness.missing(20.0, at(105))[0].since_ns == at(105)


def test_a_step_of_the_hosts_clock_moves_no_duration() -> None:
    readiness = Readiness()
    readiness.note([ROUTER], 10.0)
    assert readiness.missing(13.0, at(3_600))[0].since_ns == at(3_597)


def heard(hearing: Hearing, times_s: list[float]) -> Hearing:
    for now_s in times_s:
        hearing.hear(now_s)
    return hearing


def test_before_anything_came_all_is_silent() -> None:
    assert Hearing().is_silent(0.0)


def test_a_stream_is_silent_after_ten_seconds() -> None:
    hearing = heard(Hearing(), [tenth / 10 for tenth in range(100)])
    assert not hearing.is_silent(19.8)
    assert hearing.is_silent(20.0)


def test_what_reports_seldom_is_silent_after_three_of_its_intervals() -> None:
    hearing = heard(Hearing(), [0.0, 30.0, 60.0])
    assert not hearing.is_silent(149.0)
    assert hearing.is_silent(151.0)


def test_after_an_hours_silence_the_next_is_noticed_as_soon_as_ever() -> None:
    times_s = [tenth / 10 for tenth in range(100)]
    hearing = heard(Hearing(), [*times_s, *(3_600.0 + each for each in times_s)])
    assert hearing.is_silent(3_621.0)
