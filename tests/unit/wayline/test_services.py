"""One table of services: what goes over all of them reads it, and what cannot agrees with it."""

import re
import subprocess
import sys
import tomllib
from importlib import import_module
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import Any

import pytest

from wayline.errors import InputError
from wayline.services import SERVICES, Replayed, ServiceRow
from wayline.settings import load_settings

ROOT = Path(__file__).parents[3]
DEPLOY = ROOT / "deploy"
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
EXTRAS: dict[str, list[str]] = PROJECT["project"]["optional-dependencies"]
ROWS = list(SERVICES.values())
FOLDERS = [f"services/{row.name}" for row in ROWS]
DATA_ONLY = {"tzdata"}
"""What an extra installs that nothing imports by name."""

EIGHTH = """
import sys
from pathlib import Path
from wayline.services import SERVICES, Replayed, ServiceRow

SERVICES["made-up"] = ServiceRow("made-up", 8099, ("numpy",), Replayed.NOT)

from wayline.settings import load_settings
from wayline_cli import up
from wayline_cli.demo_files import choose_ports
from wayline_cli.doctor import doctor
from wayline_cli.local_system import LocalSystem

config = Path(sys.argv[1]) / "wayline.toml"
config.write_text('services = ["made-up"]\\nvehicle_id = "bus-1"\\n[ports]\\nmade-up = 9009\\n')
settings = load_settings(config, {})
assert settings.http_of("made-up").port == 9009
assert doctor(None, {"WAYLINE_ZENOH_CONNECT": "tcp/127.0.0.1:1"})
subjects = [check.subject for check in doctor(config, {})]
assert "port 9009 of made-up" in subjects, subjects
assert "packages of made-up" in subjects, subjects
assert choose_ports(None).http["made-up"] == 8099
assert choose_ports(18000).http["made-up"] == 18007
assert "made-up" in LocalSystem(Path(sys.argv[1])).ports
up.os.access = lambda path, mode: path.name == "wayline-made-up"
((child,),) = up.children(config, settings)
assert Path(child.command[0]).name == "wayline-made-up", child
"""


def test_an_eighth_service_is_one_row(tmp_path: Path) -> None:
    """Settings accept it, the doctor and the demo look at it, `up` finds its command."""
    # a fresh interpreter, because settings' types are made from the table as they are imported
    command = (sys.executable, "-c", EIGHTH, str(tmp_path))
    ended = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert (ended.returncode, ended.stderr) == (0, "")


@pytest.mark.parametrize(
    ("text", "place"),
    [("services = ['fusoin']", r"services\[0\]"), ("[ports]\nfusoin = 8003", "ports")],
)
def test_a_misspelt_service_is_one_line_with_the_names_there_are(
    tmp_path: Path, text: str, place: str
) -> None:
    path = tmp_path / "wayline.toml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_settings(path, {})
    names = ", ".join(sorted(SERVICES))
    line = rf".*wayline\.toml: {place}: Invalid enum value 'fusoin'; give one of {names}"
    assert re.fullmatch(line, str(caught.value)), caught.value


def test_ports_and_names_are_each_ones_own() -> None:
    assert len({row.port for row in ROWS}) == len(ROWS)
    assert all(name == row.name for name, row in SERVICES.items())


def test_every_row_has_its_folder_and_every_folder_its_row() -> None:
    found = {str(path.relative_to(ROOT)) for path in (ROOT / "services").glob("*/wayline_*")}
    assert found == {f"services/{row.name}/{row.package}" for row in ROWS}


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_what_a_row_says_of_its_package_is_there(row: ServiceRow) -> None:
    folder = ROOT / "services" / row.name / row.package
    assert (folder / "__main__.py").is_file()
    assert (folder / "migrations" / "env.py").is_file() is (row.tables is not None)
    offered = {Replayed.AS_SOURCE: "recordings", Replayed.AS_NODE: "node"}
    if row.replayed in offered:
        module = import_module(f"{row.package}.{row.replayed.value}")
        assert callable(getattr(module, offered[row.replayed]))


def test_the_project_names_the_services_of_the_table() -> None:
    scripts = {row.command: f"{row.package}.__main__:main" for row in ROWS}
    assert PROJECT["project"]["scripts"] == {"wayline": "wayline_cli.launch:main"} | scripts
    build = PROJECT["tool"]["hatch"]["build"]
    packages = [each for each in build["targets"]["wheel"]["packages"] if "services/" in each]
    assert sorted(packages) == sorted(f"services/{row.name}/{row.package}" for row in ROWS)
    for folders in (build["dev-mode-dirs"], PROJECT["tool"]["mypy"]["mypy_path"].split(":")):
        assert sorted(each for each in folders if "services/" in each) == sorted(FOLDERS)
    assert set(SERVICES) <= set(named_in_brackets(EXTRAS["all"]))


def named_in_brackets(requirements: list[str]) -> list[str]:
    """The extras that `wayline[...]` names."""
    texts = re.findall(r"wayline\[(.+)\]", " ".join(requirements))
    return [name for text in texts for name in text.split(",")]


def required_by(extra: str) -> set[str]:
    """Distributions that an extra itself names."""
    return {re.split(r"[\[<>=~]", each)[0] for each in EXTRAS[extra] if "wayline[" not in each}


def installed_by(extra: str) -> set[str]:
    """Distributions that an extra requires, those of the extras within it too."""
    return required_by(extra).union(*map(installed_by, named_in_brackets(EXTRAS[extra])))


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_what_a_service_imports_comes_with_its_extra(row: ServiceRow) -> None:
    distributions = packages_distributions()
    # a package that several share, as google, is in the distributions of all of them
    named = [set(distributions[module.partition(".")[0]]) for module in row.modules]
    assert all(each & installed_by(row.name) for each in named)
    assert required_by(row.name) - DATA_ONLY <= set().union(*named)


def test_compose_runs_services_of_the_table_on_their_ports() -> None:
    compose = (DEPLOY / "compose.yaml").read_text(encoding="utf-8")
    blocks = dict(re.findall(r"^  ([a-z-]+):\n((?:    .*\n|\n)+)", compose, re.MULTILINE))
    built = {name: text for name, text in blocks.items() if "SERVICE: " in text}
    assert set(built) == set(blocks) - {"router"}
    for name, text in built.items():
        row = SERVICES[name]
        assert f"SERVICE: {row.name}\n" in text
        assert f'"127.0.0.1:{row.port}:{row.port}"' in text
        needs_one = row.tables is not None and row.tables.lost_without is None
        assert "WAYLINE_DATABASE_URL: " in text or not needs_one


def test_the_image_and_the_unit_start_services_by_their_commands() -> None:
    dockerfile = (DEPLOY / "Dockerfile").read_text(encoding="utf-8")
    (listed,) = re.findall(r"^# SERVICE: (.+)\.$", dockerfile, re.MULTILINE)
    assert re.split(r", | or ", listed) == list(SERVICES)
    assert 'ln -s "wayline-$SERVICE"' in dockerfile
    unit = (DEPLOY / "systemd" / "wayline@.service").read_text(encoding="utf-8")
    assert "\nExecStart=/opt/wayline/bin/wayline-%i --config" in unit
    assert all(row.command == f"wayline-{row.name}" for row in ROWS)
    guide = (ROOT / "docs" / "deploy.md").read_text(encoding="utf-8")
    named = re.findall(r"wayline@([a-z][a-z-]*)", unit + guide)
    assert named
    assert set(named) <= set(SERVICES)


def test_the_example_configuration_shows_every_port() -> None:
    text = (DEPLOY / "wayline.toml").read_text(encoding="utf-8")
    table = text.partition("\n[ports]\n")[2].partition("\n[")[0]
    shown = re.findall(r"^#([a-z-]+) = (\d+)$", table, re.MULTILINE)
    assert {name: int(port) for name, port in shown} == {row.name: row.port for row in ROWS}
