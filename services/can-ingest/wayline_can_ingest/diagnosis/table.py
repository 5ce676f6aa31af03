"""Pure: tables for a configuration or drive file, as text to paste."""

import json
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import PurePath

import msgspec

from wayline.drive import Places
from wayline.live_sources import LiveCan
from wayline_can_ingest.diagnosis.proposal import Proposal


def recorded(paths: Sequence[PurePath]) -> list[str]:
    """The keys of a `[[can]]` that is a recording, the paths as they shall stand there."""
    return [f"path = {_listed(paths)}"]


def live(source: LiveCan) -> list[str]:
    """The keys of a `[[can]]` that is a bus."""
    lines = [f"interface = {json.dumps(source.interface)}"]
    lines.append(f"channel = {json.dumps(source.channel)}")
    if source.bitrate is not None:
        lines.append(f"bitrate = {source.bitrate}")
    if source.options:
        options = ", ".join(f"{key} = {json.dumps(value)}" for key, value in source.options.items())
        lines.append(f"options = {{ {options} }}")
    return lines


def profile_table(names: Sequence[str]) -> str:
    """A `[vehicle]` with its profiles."""
    value = json.dumps(names[0]) if len(names) == 1 else json.dumps(list(names))
    return f"[vehicle]\nprofile = {value}"


def can_table(
    source: Iterable[str],
    dbc: Sequence[PurePath] = (),
    proposals: Iterable[Proposal] = (),
    *,
    j1939: bool = False,
) -> str:
    """A `[[can]]` with its `[can.signals]`; the paths of `dbc` as they shall stand there."""
    lines = ["[[can]]", *source]
    if dbc:
        lines.append(f"dbc = {_listed(dbc)}")
    if j1939:
        lines.append("j1939 = true")
    mapped = [each.line for each in proposals]
    return "\n".join([*lines, *(["", "[can.signals]", *mapped] if mapped else [])])


def signals_of(table: str) -> Mapping[str, Places]:
    """What can-ingest reads in such a table."""
    return msgspec.convert(tomllib.loads(table)["can"][0].get("signals", {}), dict[str, Places])


def _listed(paths: Sequence[PurePath]) -> str:
    return json.dumps([str(path) for path in paths])
