"""Reads scenarios, those that come with Wayline and those of the user."""

from pathlib import Path

from wayline.errors import InputError
from wayline.strict import fitted
from wayline.toml import read_toml
from wayline_simulator.scenario import Scenario, check

SHIPPED = Path(__file__).with_name("scenarios")


def shipped_scenarios() -> dict[str, str]:
    """Names and descriptions of the scenarios that come with Wayline."""
    return {
        path.stem: load_scenario(path.stem).description for path in sorted(SHIPPED.glob("*.toml"))
    }


def load_scenario(name: str) -> Scenario:
    """A shipped scenario by name, or one of the user's by path. Raises InputError."""
    path = SHIPPED / f"{name}.toml"
    if not path.is_file():
        path = Path(name)
        if not path.suffix:
            names = ", ".join(sorted(file.stem for file in SHIPPED.glob("*.toml")))
            raise InputError("--scenario", f"{name} is not known", f"give a file or {names}")
    scenario = fitted(read_toml(path), Scenario, str(path))
    check(scenario, str(path))
    return scenario
