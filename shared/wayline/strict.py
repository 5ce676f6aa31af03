"""Pure: tables of a file as frozen Structs; what does not fit is one clear error."""

import re
from collections.abc import Iterator
from typing import TypeVar

import msgspec

from wayline.errors import InputError

StructType = TypeVar("StructType", bound=msgspec.Struct)


class Strict(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A table of a configuration or drive file; a key that it does not know is refused."""


def fitted(tables: object, struct: type[StructType], where: str) -> StructType:
    """Tables as a struct, or raise InputError naming `where`, the key and the mend."""
    try:
        return msgspec.convert(tables, struct)
    except msgspec.ValidationError as error:
        raise _explained(where, error, struct) from None


def _explained(
    where: str, error: msgspec.ValidationError, struct: type[msgspec.Struct]
) -> InputError:
    message, _, place = str(error).partition(" - at `")
    is_name, place = place.startswith("key` in `"), place.removeprefix("key` in `")
    key = place.strip("`").lstrip("$.") or "top level"
    if unknown := re.search(r"unknown field `(.+)`", message):
        name = unknown[1] if key == "top level" else f"{key}.{unknown[1]}"
        return InputError(where, f"unknown key {name}", "remove it or correct its spelling")
    if missing := re.search(r"missing required field `(.+)`", message):
        name = missing[1] if key == "top level" else f"{key}.{missing[1]}"
        return InputError(where, f"missing key {name}", "add it")
    choices = _choices(struct, key, is_name=is_name)
    mend = f"give one of {', '.join(choices)}" if choices else "correct that value"
    return InputError(where, f"{key}: {message}", mend)


def _choices(struct: type[msgspec.Struct], key: str, *, is_name: bool) -> list[str]:
    """The words that a value, or a name in a table, may be; empty where it is no word of a few."""
    kinds = [msgspec.inspect.type_info(struct)]
    for name in re.findall(r"[^.\[\]]+", key.replace("[...]", "[*]")):
        kinds = [inner for kind in kinds for inner in _within(kind, name)]
    if is_name:
        kinds = [kind.key_type for kind in kinds if isinstance(kind, msgspec.inspect.DictType)]
    literals = (kind for kind in kinds if isinstance(kind, msgspec.inspect.LiteralType))
    return [str(value) for literal in literals for value in literal.values]


def _within(kind: msgspec.inspect.Type, name: str) -> Iterator[msgspec.inspect.Type]:
    """Types of one place in a table or list."""
    match kind:
        case msgspec.inspect.UnionType():
            for each in kind.types:
                yield from _within(each, name)
        case msgspec.inspect.StructType():
            yield from (field.type for field in kind.fields if field.encode_name == name)
        case msgspec.inspect.VarTupleType() | msgspec.inspect.ListType():
            yield kind.item_type
        case msgspec.inspect.DictType():
            yield kind.value_type
