"""Profiles: what is known of a kind of vehicle or box, as data that can-ingest ships.

A profile's frames and signals are can-ingest's own business; the vehicle's figures in it (mass,
wheels, air) are for every service, so that they are laid under `[vehicle]` here.
"""

import difflib
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from wayline.errors import InputError
from wayline.toml import read_toml

PACKAGE = "wayline_can_ingest"
"""Named, not imported: its files are read, none of its code."""


def profile_folder() -> Path:
    """Where `<name>.toml` and `<name>.dbc` of every profile are."""
    return Path(str(files(PACKAGE))) / "profiles"


def profile_names() -> list[str]:
    """The profiles there are."""
    return sorted(path.stem for path in profile_folder().glob("*.toml"))


def profile_path(name: str, where: str) -> Path:
    """The TOML file of a profile, or InputError with the names that there are."""
    names = profile_names()
    if name in names:
        return profile_folder() / f"{name}.toml"
    near = difflib.get_close_matches(name, names, n=1)
    mend = f"did you mean {near[0]}?" if near else f"there are {', '.join(names)}"
    raise InputError(where, f'vehicle.profile: no profile "{name}"', mend)


def with_profiles(tables: Mapping[str, Any], where: str) -> dict[str, Any]:
    """A file's tables with the profiles' figures where `[vehicle]` gives none itself."""
    vehicle = tables.get("vehicle")
    if not isinstance(vehicle, dict) or "profile" not in vehicle:
        return dict(tables)
    named = vehicle["profile"]
    names = named if isinstance(named, list) else [named]
    known: dict[str, Any] = {}
    for name in reversed(names):
        known |= read_toml(profile_path(str(name), where)).get("vehicle", {})
    return {**tables, "vehicle": known | vehicle}
