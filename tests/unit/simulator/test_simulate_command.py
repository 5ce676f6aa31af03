"""`wayline simulate` on the command line: what it does to a folder that is in use."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

COMMAND = [sys.executable, "-m", "wayline_cli", "simulate", "--road", "urban", "--length-m", "1500"]
WAIT_S = 60.0


def simulated(out: Path, *options: str, stdin: int = subprocess.DEVNULL) -> tuple[int, str]:
    """Status and what it said."""
    done = subprocess.run(
        [*COMMAND, "--out", str(out), *options],
        stdin=stdin,
        capture_output=True,
        text=True,
        timeout=WAIT_S,
        check=False,
    )
    return done.returncode, done.stderr


@pytest.fixture
def full(tmp_path: Path) -> Path:
    """A folder with a drive that somebody wants to keep."""
    folder = tmp_path / "drive"
    folder.mkdir()
    (folder / "drive.toml").write_text("mine")
    return folder


def test_a_folder_with_files_is_left_alone_without_a_terminal(full: Path) -> None:
    status, said = simulated(full)
    expected = f"wayline: {full}: has files already; name an empty folder, or give --force\n"
    assert (status, said) == (2, expected)
    assert (full / "drive.toml").read_text() == "mine"


def test_force_writes_into_it(full: Path) -> None:
    assert simulated(full, "--force") == (0, "")
    assert (full / "drive.toml").read_text() != "mine"


@pytest.mark.parametrize(("answer", "status"), [("y\n", 0), ("n\n", 2)])
def test_on_a_terminal_it_asks(full: Path, answer: str, status: int) -> None:
    ours, theirs = pty.openpty()
    try:
        os.write(ours, answer.encode())
        assert simulated(full, stdin=theirs)[0] == status
    finally:
        os.close(ours)
        os.close(theirs)
    assert ((full / "drive.toml").read_text() == "mine") is (status == 2)
