"""Keeps beside a simulated drive what it was made with, as `simulation.json`."""

from pathlib import Path

import msgspec

from wayline.errors import InputError
from wayline_simulator.facts import Facts

FILE_NAME = "simulation.json"


def write_facts(facts: Facts, folder: Path) -> None:
    """Write the facts beside their drive."""
    data = msgspec.json.format(msgspec.json.encode(facts), indent=2)
    (folder / FILE_NAME).write_bytes(data + b"\n")


def read_facts(folder: Path) -> Facts | None:
    """The facts of a simulated drive; None for a recorded one. Raises InputError."""
    path = folder / FILE_NAME
    if not path.exists():
        return None
    try:
        return msgspec.json.decode(path.read_bytes(), type=Facts)
    except msgspec.DecodeError as error:
        raise InputError(str(path), str(error), "simulate the drive again") from None
