from wayline.rfc3339 import rfc3339


def test_an_instant_has_milliseconds_and_z() -> None:
    assert rfc3339(1_542_031_402_345_678_901) == "2018-11-12T14:03:22.345Z"


def test_a_whole_second_keeps_its_zeros() -> None:
    assert rfc3339(0) == "1970-01-01T00:00:00.000Z"


def test_milliseconds_are_cut_so_that_an_instant_is_never_in_the_future() -> None:
    assert rfc3339(1_999_999_999) == "1970-01-01T00:00:01.999Z"
