"""Works take turns."""

from functools import partial

from wayline_bench.rounds import in_turns


def test_works_take_turns_and_the_first_round_is_not_kept() -> None:
    """Every other round goes backwards, so that nobody always follows the same neighbour."""
    calls: list[str] = []
    works = {name: partial(calls.append, name) for name in "abc"}
    spent_s = in_turns(works, 2, lambda _: None)
    assert "".join(calls) == "cbaabccba"
    assert {name: len(rounds) for name, rounds in spent_s.items()} == {"a": 2, "b": 2, "c": 2}
