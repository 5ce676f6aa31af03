"""`wayline simulate` on the command line: what it does to a folder that is in use."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

from wayline.drive_file import load_drive

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


def network(out: Path, *options: str) -> tuple[int, str]:
    """Status of `wayline simulate network` and what it said on either stream."""
    command = [sys.executable, "-m", "wayline_cli", "simulate", "network", "--out", str(out)]
    done = subprocess.run(
        [*command, *options], capture_output=True, text=True, timeout=WAIT_S, check=False
    )
    return done.returncode, done.stdout + done.stderr


def test_a_network_is_a_feed_and_a_drive_for_each_bus_and_day(tmp_path: Path) -> None:
    out = tmp_path / "network"
    status, said = network(out, "--vehicles", "1", "--days", "2", "--hours", "0.5", "--assigned")
    assert status == 0
    assert {each.name for each in out.iterdir()} == {"feed", "bus-1-day-1", "bus-1-day-2"}
    assert said.startswith(f"{out}/bus-1-day-1: 1 trips, ")
    assert 'assignment = "block"' in (out / "bus-1-day-1" / "drive.toml").read_text()


def test_a_network_that_cannot_be_is_one_line(tmp_path: Path) -> None:
    status, said = network(tmp_path / "network", "--vehicles", "0")
    expected = "vehicles: Expected `int` >= 1; correct that value"
    assert (status, said) == (2, f"wayline: wayline simulate network: {expected}\n")


def test_a_network_leaves_a_folder_with_files_alone(full: Path) -> None:
    status, said = network(full)
    assert status == 2
    assert "has files already" in said


def test_raw_is_asked_for_by_name(tmp_path: Path) -> None:
    assert simulated(tmp_path / "drive", "--raw") == (0, "")
    assert (tmp_path / "drive" / "raw.csv").stat().st_size > 10_000
    assert load_drive(tmp_path / "drive").raw[0].corrected == ("atmosphere", "satellite_clock")
