"""The command on an installation that lacks a package."""

import subprocess
import sys

import pytest

WITHOUT = """
import sys
sys.modules[{package!r}] = None
sys.argv = ["wayline", *{arguments!r}]
from wayline_cli.launch import main
main()
"""


@pytest.mark.parametrize(
    ("package", "arguments"),
    [("typer", ["--version"]), ("mcap", ["record", "a.mcap"])],
)
def test_a_package_that_is_missing_is_said_in_one_line(package: str, arguments: list[str]) -> None:
    """At the start, or where a command first needs it."""
    code = WITHOUT.format(package=package, arguments=arguments)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith(f"wayline: this command needs the package {package}, which is")
    assert done.stderr.endswith("pip install --constraint constraints.txt '.[cli]', or '.[all]'\n")
    assert done.stderr.count("\n") == 1
