"""A short form of tests/fuzz/fuzz_text_files.py: whatever a text file holds, no exception, no hang.

Every small file is cut at every byte and loses every block of 8 bytes, plain and packed; then some
thousands of files have other faults.
"""

import gzip
from collections import Counter
from pathlib import Path

import pytest

from fuzz.fuzz_text_files import SEEDS, Read, outcome, run_file

FILES = 2_000


@pytest.mark.parametrize(("content", "read"), SEEDS)
@pytest.mark.parametrize("packed", [False, True])
def test_a_file_that_is_cut_or_zeroed_anywhere_is_read_or_refused(
    content: bytes, read: Read, packed: bool, tmp_path: Path
) -> None:
    whole = gzip.compress(content, mtime=0) if packed else content
    path = tmp_path / "file"
    outcomes = Counter(outcome(whole[:end], read, path) for end in range(len(whole)))
    for at in range(0, len(whole), 8):
        zeroed = whole[:at] + bytes(8) + whole[at + 8 :]
        outcomes[outcome(zeroed, read, path)] += 1
    assert outcome(whole, read, path) == ("refused" if packed and content[:2] == b"PK" else "read")
    assert outcomes["refused"] > 0


def test_files_with_faults_of_every_kind_are_read_or_refused(tmp_path: Path) -> None:
    """The same files each time."""
    outcomes = Counter(run_file(number, tmp_path / "file") for number in range(FILES))
    assert min(outcomes["read"], outcomes["refused"]) > FILES // 10
