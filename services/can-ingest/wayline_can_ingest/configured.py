"""Loads what a `[[can]]` and its vehicle's profiles name, and compiles it."""

from collections.abc import Mapping as AnyMapping
from pathlib import Path
from typing import Any

from wayline.drive import CanMapping, Places, Vehicle
from wayline.profile import profile_path
from wayline.strict import Strict
from wayline.toml import load_toml
from wayline_can_ingest.dbc import load_database, load_databases
from wayline_can_ingest.directory import Part
from wayline_can_ingest.mapping import Mapping, compile_mapping


class Profile(Strict, frozen=True, kw_only=True):
    """A profile's TOML file; the database beside it has the same name."""

    description: str
    j1939: bool = False
    signals: AnyMapping[str, Places]
    vehicle: AnyMapping[str, Any] = {}
    """Figures in place of the car's, as `[vehicle]` has them."""


def load_profile(name: str, where: str) -> Part:
    """A profile by name; InputError, naming `where` it was asked for, if there is none."""
    path = profile_path(name, where)
    profile = load_toml(path, Profile)
    database = load_database(path.with_suffix(".dbc"))
    return Part(f"profile {name}", profile.signals, profile.j1939, [database])


def load_mapping(source: CanMapping, vehicle: Vehicle, where: str) -> Mapping:
    """The compiled mapping of a source with its vehicle's profiles. Raises InputError."""
    databases = load_databases([Path(path) for path in source.dbc])
    profiles = [load_profile(name, where) for name in vehicle.profiles]
    return compile_mapping(source, databases, vehicle, where, profiles)
