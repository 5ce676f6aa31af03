"""Pure: key expressions of the bus (SPEC section 2)."""

import re
from typing import NamedTuple

from wayline.drive import VEHICLE_ID_PATTERN
from wayline.messages import TEXT_MAX, TOPICS

ROOT = "wayline/v1"
FORMER_ROOT = "wayline/@v1"
"""Of recordings made before the bus moved."""
FLEET = "_fleet"
"""Stands for the vehicle in keys of a service that serves many."""


class Key(NamedTuple):
    """The parts of a message's key."""

    vehicle_id: str
    topic: str
    source: str


def message_key(vehicle_id: str, topic: str, source: str) -> str:
    """Key of a message; `*` as vehicle or source makes it an expression."""
    return f"{ROOT}/{vehicle_id}/{topic}/{source}"


def alive_key(vehicle_id: str, service: str) -> str:
    """Key of a service's liveliness token."""
    return f"{ROOT}/{vehicle_id}/@alive/{service}"


def query_key(vehicle_id: str, name: str) -> str:
    """Key of a queryable."""
    return f"{ROOT}/{vehicle_id}/@query/{name}"


def parse_key(key: str) -> Key | None:
    """The parts of a message's key; None for a key that is not one of ours."""
    parts = key.split("/")
    if len(parts) != 5 or "/".join(parts[:2]) != ROOT:
        return None
    _, _, vehicle_id, topic, source = parts
    if topic not in TOPICS or not _is_home(vehicle_id) or len(source) > TEXT_MAX:
        return None
    return Key(vehicle_id, topic, source)


def parse_alive_key(key: str) -> tuple[str, str] | None:
    """The vehicle and the service of a liveliness token; None for a key that is not one of ours."""
    parts = key.split("/")
    if len(parts) != 5 or "/".join(parts[:2]) != ROOT:
        return None
    _, _, vehicle_id, _, service = parts
    return (vehicle_id, service) if _is_home(vehicle_id) and len(service) <= TEXT_MAX else None


def current_key(key: str) -> str:
    """The key under which a recorded message is published today."""
    former = f"{FORMER_ROOT}/"
    return f"{ROOT}/{key.removeprefix(former)}" if key.startswith(former) else key


def _is_home(vehicle_id: str) -> bool:
    return vehicle_id == FLEET or is_vehicle_id(vehicle_id)


def is_vehicle_id(text: str) -> bool:
    """Whether a text may be a vehicle's id."""
    return re.fullmatch(VEHICLE_ID_PATTERN.strip("^$"), text) is not None
