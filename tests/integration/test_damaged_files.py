"""A minute of what `scripts/siege files` does for ten."""

import os
import subprocess
import sys
from pathlib import Path

TESTS = Path(__file__).parents[1]


def test_a_minute_of_damaged_files_is_read_or_refused() -> None:
    """No exception, no file that takes its time, memory flat; see the script."""
    done = subprocess.run(
        [sys.executable, TESTS / "fuzz" / "fuzz_files.py", "--minutes", "1"],
        env={**os.environ, "PYTHONPATH": str(TESTS)},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr[-2000:]
