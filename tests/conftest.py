"""What every test can ask for."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest


@pytest.fixture
def recorded() -> Callable[[str], Path]:
    """A folder of recorded data, or skip with the reason."""

    def find(folder: str) -> Path:
        place = os.environ.get("WAYLINE_DATA")
        if not place:
            pytest.skip("WAYLINE_DATA: not set, recorded drives are not tested")
        path = Path(place) / folder
        if not path.is_dir():
            pytest.skip(f"WAYLINE_DATA: no folder {folder} in {place}")
        return path

    return find
