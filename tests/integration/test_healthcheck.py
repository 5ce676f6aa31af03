"""The container's health check asks the service where its configuration says that it is."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from fastapi import FastAPI, Response

from wayline.http_server import HttpServer
from wayline.http_settings import HttpSettings

SCRIPT = Path(__file__).parents[2] / "deploy/healthcheck.py"


@pytest.mark.parametrize(("status", "exit_status"), [(200, 0), (503, 1)])
def test_the_health_check_passes_on_what_livez_says(
    tmp_path: Path, status: int, exit_status: int
) -> None:
    app = FastAPI()
    app.add_api_route("/livez", lambda: Response(status_code=status))
    with HttpServer(app, HttpSettings(port=0)) as server:
        port = server.port
        assert check(tmp_path, port) == exit_status
    assert check(tmp_path, port) == 1


def check(folder: Path, port: int) -> int:
    """Exit status of the script for a service on this port."""
    config = folder / "wayline.toml"
    config.write_text(f"ports = {{ eta = {port} }}", encoding="utf-8")
    command = [sys.executable, str(SCRIPT), str(config)]
    ended = subprocess.run(command, env={**os.environ, "SERVICE": "eta"}, check=False, timeout=30)
    return ended.returncode
