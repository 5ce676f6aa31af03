"""A vehicle has as many services on the page as it can have, whatever names are made up."""

import msgspec

from builders import at
from wayline.attendance import SOURCES_MAX
from wayline.messages import Health
from wayline_dashboard.roll import Roll


def health(service: str) -> Health:
    return Health(t_ns=at(0), service=service, version="0", started_ns=at(0))


def names(roll: Roll) -> list[str]:
    return [view.service for view in roll.views()]


def test_made_up_names_do_not_swell_the_page_nor_push_out_what_is_up() -> None:
    roll = Roll()
    roll.note("eta", is_up=True)
    for number in range(5_000):
        roll.hear(health(f"made-up-{number:04}"))
    assert len(names(roll)) == SOURCES_MAX
    assert names(roll)[0] == "eta"
    assert names(roll)[-1] == "made-up-4999"
    assert len(msgspec.json.encode(roll.views())) < 10_000


def test_made_up_tokens_are_not_shown_beyond_what_fits() -> None:
    roll = Roll()
    assert [roll.note(f"made-up-{number}", is_up=True) for number in range(20)] == (
        [True] * SOURCES_MAX + [False] * 4
    )
    roll.note("made-up-3", is_up=False)
    assert roll.note("eta", is_up=True)
    assert "made-up-3" not in names(roll)


def test_what_was_heard_last_stays() -> None:
    roll = Roll()
    for number in range(SOURCES_MAX):
        roll.hear(health(f"service-{number}"))
    roll.hear(health("service-0"))
    roll.hear(health("newcomer"))
    assert "service-0" in names(roll)
    assert "service-1" not in names(roll)
