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

    def __init__(self, depth_ns: int = 1_000) -> None:
        self.happened: tuple[int, ...] = ()
        self.timeline: Timeline[Noted, tuple[int, ...]] = Timeline(
            self._apply, lambda: self.happened, self._restore, depth_ns
        )

    def _apply(self, event: Noted) -> None:
        self.happened = (*self.happened, event.t_ns)

    def _restore(self, state: tuple[int, ...]) -> None:
        self.happened = state


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
