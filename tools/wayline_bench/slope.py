"""`bench slope`: merging a run, looking ahead at a large map, a further vehicle's memory."""

import tempfile
from pathlib import Path

from wayline_bench.rounds import Say
from wayline_bench.row import Row
from wayline_bench.slope_http import http_rows
from wayline_bench.slope_memory import memory_row
from wayline_bench.slope_merge import merge_rows


def bench(say: Say) -> list[Row]:
    """Every row; needs no recorded data."""
    with tempfile.TemporaryDirectory(prefix="wayline-bench-") as temporary:
        return [*merge_rows(Path(temporary), say), *http_rows(say), memory_row(say)]
