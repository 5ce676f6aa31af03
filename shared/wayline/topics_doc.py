"""Pure: `docs/topics.md`, generated from the messages.

`python -m wayline.topics_doc > docs/topics.md` writes it; a test fails when the file is stale.
"""

import ast
import inspect
import sys
import textwrap
import typing
from collections.abc import Iterator
from types import NoneType, UnionType

import msgspec

from wayline.messages import (
    COUNT_MAX,
    MESSAGES,
    QUANTITY_MAX,
    Message,
    TimeNs,
    field_types,
    stale_after_s,
)

HEAD = """# Topics of the bus

Generated from `shared/wayline/messages.py` by `python -m wayline.topics_doc`; do not edit.

Key: `wayline/v1/<vehicle_id>/<topic>/<source>`. Payload: JSON of one message. A field that may be
null is unknown when null. Units are in the names. No number is larger than 1e9, no count than 2^53,
unless a bound is told; what lies beyond its bound is bad input.
"""
UNSAID = {QUANTITY_MAX, COUNT_MAX}
"""Bounds that the head tells of all."""


def render() -> str:
    """The whole page."""
    return HEAD + "".join(_topic(message) for message in MESSAGES)


def _topic(message: type[Message]) -> str:
    purpose = inspect.cleandoc(message.__doc__ or "")
    rate = f"Nominally {message.rate_hz:g} Hz; stale after {stale_after_s(message):g} s."
    parts = [f"\n## {message.topic}\n\n{purpose}\n\n{rate}\n\n", _table(message)]
    for name, struct in _structs(message):
        parts.append(f"\nEach of `{name}` ({inspect.cleandoc(struct.__doc__ or '')})\n\n")
        parts.append(_table(struct))
    return "".join(parts)


def _table(struct: type[msgspec.Struct]) -> str:
    notes = _notes(struct)
    rows = [
        f"| `{name}` | {_type(annotation)} | {notes.get(name, '')} |\n"
        for name, annotation in field_types(struct).items()
    ]
    return "| field | type | |\n|---|---|---|\n" + "".join(rows)


def _structs(message: type[Message]) -> list[tuple[str, type[msgspec.Struct]]]:
    """Fields that hold lists of objects, with the object's type."""
    return [
        (name, part)
        for name, annotation in field_types(message).items()
        for part in _parts(annotation)
        if isinstance(part, type) and issubclass(part, msgspec.Struct)
    ]


def _parts(annotation: object) -> Iterator[object]:
    """Everything that a type is put together of."""
    for part in typing.get_args(annotation):
        yield part
        yield from _parts(part)


def _type(annotation: object) -> str:
    origin, parts = typing.get_origin(annotation), typing.get_args(annotation)
    if annotation == TimeNs:
        return "nanoseconds since 1970, in 1980 to 2100"
    if origin is typing.Annotated:
        return f"{_type(parts[0])} {_bounds(parts[1:])}".strip()
    if origin in (typing.Union, UnionType):
        known = ", ".join(_type(part) for part in parts if part is not NoneType)
        return f"{known} or null" if NoneType in parts else known
    if origin is typing.Literal:
        return ", ".join(f"`{value}`" for value in parts)
    if origin is tuple:
        return "list of objects"
    return {"int": "integer", "float": "number", "str": "text", "bool": "boolean"}[
        getattr(annotation, "__name__", "")
    ]


def _bounds(metas: tuple[object, ...]) -> str:
    signs = {"ge": ">=", "gt": ">", "le": "<=", "lt": "<", "max_length": "of at most"}
    return ", ".join(
        f"{sign} {bound:g}"
        for meta in metas
        for name, sign in signs.items()
        if (bound := getattr(meta, name, None)) is not None and abs(bound) not in UNSAID
    )


def _notes(struct: type[msgspec.Struct]) -> dict[str, str]:
    """Strings that stand below a field in the source, by field."""
    (body,) = ast.parse(textwrap.dedent(inspect.getsource(struct))).body
    notes: dict[str, str] = {}
    field = ""
    for node in getattr(body, "body", []):
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            field = node.target.id
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and field:
            notes[field] = " ".join(str(node.value.value).split())
    return notes


if __name__ == "__main__":
    sys.stdout.write(render())
