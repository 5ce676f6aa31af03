"""Short forms of `scripts/siege server|disk`, and addresses that only editing mends."""

import re
import subprocess
from pathlib import Path

import pytest

from postgres import Cluster
from siege.disk import full, siege
from siege.server import server_away
from wayline_cli.local_system import LocalSystem

WAIT_S = 20.0


@pytest.fixture(autouse=True)
def busy_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """Other tests may run beside these: whoever waited for a database would wait for seconds."""
    monkeypatch.setattr("siege.rig.GAP_MAX_S", 1.0)


def test_a_server_that_is_away_stopped_and_frozen_costs_no_pose_and_no_run(
    tmp_path: Path, postgres: Cluster
) -> None:
    server_away(tmp_path, postgres, 1.0)


def test_a_disk_that_is_full_costs_no_pose_and_no_run(tmp_path: Path) -> None:
    siege(tmp_path, 0.5, [full])


@pytest.mark.parametrize(
    ("service", "url", "said"),
    [
        ("fusion", "postgresql://me:s3cret@127.0.0.1:54x2/x", "has a port that is no number"),
        ("slope-map", "postgresql://127.0.0.1:1/x?password=s3cret&nonsense=1", "nonsense"),
    ],
)
def test_an_address_to_mend_is_one_line_without_its_password(
    tmp_path: Path, service: str, url: str, said: str
) -> None:
    system = LocalSystem(tmp_path, vehicle_id="bus-1", database_url=url)
    done = subprocess.run(
        (*system.command(service), "--config", str(system.config)),
        capture_output=True,
        text=True,
        timeout=WAIT_S,
        check=False,
    )
    assert done.returncode == 2
    assert re.fullmatch(rf"wayline-{service}: .*{re.escape(said)}.*\n", done.stderr)
    assert "s3cret" not in done.stdout + done.stderr
