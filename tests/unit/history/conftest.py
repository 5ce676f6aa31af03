"""A history that is closed when its test is over."""

from collections.abc import Callable, Iterator

import pytest

from unit.history.keeping import History


@pytest.fixture
def open_history() -> Iterator[Callable[[str], History]]:
    """Opens a history by its address."""
    opened: list[History] = []

    def open_(url: str) -> History:
        opened.append(History(url))
        return opened[-1]

    yield open_
    for history in opened:
        history.engine.dispose()
