"""Late events are applied at their own time."""

from typing import NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wayline_fusion.filter.timeline import Timeline


class Noted(NamedTuple):
    t_ns: int


class Story:
    """A state in which order matters: the list of what happened."""

    takes: frozenset[type] = frozenset({Noted})

    def __init__(self, depth_ns: int = 1_000) -> None:
        self.happened: tuple[int, ...] = ()
        self.timeline: Timeline[Noted] = Timeline([self], depth_ns)

    def apply(self, event: Noted) -> None:
        self.happened = (*self.happened, event.t_ns)

    def snapshot(self) -> tuple[int, ...]:
        return self.happened

    def restore(self, snapshot: tuple[int, ...]) -> None:
        self.happened = snapshot


@given(st.lists(st.integers(0, 999), min_size=1))
def test_any_order_of_arrival_ends_in_the_order_of_time(times_ns: list[int]) -> None:
    story = Story()
    assert all(story.timeline.add(Noted(t_ns)) for t_ns in times_ns)
    assert story.happened == tuple(sorted(times_ns))


def test_what_is_older_than_the_history_is_refused_and_changes_nothing() -> None:
    story = Story(depth_ns=10)
    for t_ns in (0, 20, 40):
        story.timeline.add(Noted(t_ns))
    assert not story.timeline.add(Noted(29))
    assert story.happened == (0, 20, 40)


@pytest.mark.parametrize("late_ns", [30, 35, 40])
def test_what_is_just_within_the_history_is_taken(late_ns: int) -> None:
    story = Story(depth_ns=10)
    for t_ns in (0, 20, 40):
        story.timeline.add(Noted(t_ns))
    assert story.timeline.add(Noted(late_ns))
    assert sorted(story.happened) == list(story.happened)


def test_events_of_one_instant_keep_their_order_when_they_come_late() -> None:
    class Part(NamedTuple):
        t_ns: int
        name: str

    class Parts:
        takes: frozenset[type] = frozenset({Part})

        def __init__(self) -> None:
            self.named = ""

        def apply(self, event: Part) -> None:
            self.named += event.name

        def snapshot(self) -> str:
            return self.named

        def restore(self, snapshot: str) -> None:
            self.named = snapshot

    parts = Parts()
    timeline: Timeline[Part] = Timeline([parts], 1_000)
    timeline.add(Part(10, "a"))
    timeline.add(Part(30, "z"))
    timeline.add(Part(20, "b"), Part(20, "c"), Part(20, "d"))
    assert parts.named == "abcdz"


def test_a_state_is_given_only_what_it_takes_and_set_back_with_the_others() -> None:
    class Other(NamedTuple):
        t_ns: int

    story, deaf = Story(), Story()
    deaf.takes = frozenset()
    timeline: Timeline[Noted | Other] = Timeline([story, deaf], 1_000)  # type: ignore[list-item]
    for event in (Noted(1), Other(3), Noted(2)):
        timeline.add(event)
    assert (story.happened, deaf.happened) == ((1, 2), ())
