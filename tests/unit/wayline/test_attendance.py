"""Who is heard: sources in bounds, silent ones forgotten."""

from wayline.attendance import QUIET_S, SOURCES_MAX, Attendance
from wayline.keys import Key, parse_alive_key, parse_key


def key(source: str, topic: str = "health") -> Key:
    return Key("bus-7", topic, source)


def test_a_source_too_many_is_refused_as_long_as_the_others_speak() -> None:
    attendance = Attendance()
    for second in range(100):
        for number in range(SOURCES_MAX):
            assert attendance.admits(key(f"source-{number}"), float(second))
        assert not attendance.admits(key("one-more"), float(second))
    assert attendance.admits(key("one-more", "pose"), 100.0)


def test_made_up_sources_that_fell_silent_give_their_place_to_a_new_one() -> None:
    attendance = Attendance()
    for number in range(SOURCES_MAX):
        attendance.admits(key(f"made-up-{number}"), float(number))
    assert not attendance.admits(key("fusion"), QUIET_S - 1.0)
    assert attendance.admits(key("fusion"), QUIET_S)
    assert not attendance.admits(key("made-up-0"), QUIET_S)


def test_names_longer_than_a_text_are_nobodys() -> None:
    assert parse_key(f"wayline/v1/bus-7/pose/{'x' * 256}") is not None
    assert parse_key(f"wayline/v1/bus-7/pose/{'x' * 257}") is None
    assert parse_alive_key(f"wayline/v1/bus-7/@alive/{'x' * 257}") is None
    assert parse_alive_key("wayline/v1/Bus 7/@alive/eta") is None
    assert parse_alive_key("wayline/v1/_fleet/@alive/eta") == ("_fleet", "eta")
