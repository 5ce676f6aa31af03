"""A line that a file holds, before it is a route; which one of several is meant."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from wayline.errors import InputError
from wayline.stops import StopPlace

SHOWN = 5
"""Names that a refusal lists."""


class ImportedLine(NamedTuple):
    """A line with what its file says of it."""

    line_id: str
    """Empty where the file gives it none."""
    name: str
    vertices: Sequence[tuple[float, float]]
    """Latitude and longitude in degrees."""
    speeds_mps: Sequence[float] | None = None
    """One a leg; a closed line may have one more, of the leg that closes it."""
    stops: Sequence[StopPlace] = ()
    loop: bool = False


def only_line(path: Path, lines: Sequence[ImportedLine], wanted: str | None) -> ImportedLine:
    """The line of an id, a name or a number from 1 on; without one the only line of the file.

    Raises InputError where there is none, or several.
    """
    known = [line.line_id or line.name or str(at) for at, line in enumerate(lines, start=1)]
    listed = ", ".join(known[:SHOWN]) + (", ..." if len(known) > SHOWN else "")
    if not lines:
        raise InputError(str(path), "holds no line", "give a file with a line, a track or a route")
    if wanted is None and len(lines) == 1:
        return lines[0]
    if wanted is None:
        raise InputError(str(path), f"holds {len(lines):,} lines ({listed})", "name one by --line")
    for number, line in enumerate(lines, start=1):
        if wanted in (line.line_id, line.name, str(number)):
            return line
    raise InputError(f"--line {wanted}", f"{path} has no such line", f"name one of {listed}")
