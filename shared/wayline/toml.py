"""Reads a TOML file into a frozen Struct; what does not fit is one clear error."""

import re
import tomllib
from pathlib import Path
from typing import TypeVar

import msgspec

from wayline.errors import InputError

StructType = TypeVar("StructType", bound=msgspec.Struct)


class Strict(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A table of a configuration or drive file; a key that it does not know is refused."""


def load_toml(path: Path, struct: type[StructType]) -> StructType:
    """Read `path` into `struct`, or raise InputError naming the file, the key and the mend."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(str(path), "no such file", "check the path") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), f"cannot be read ({error})", "check the file") from None
    try:
        return msgspec.convert(tomllib.loads(text), struct)
    except tomllib.TOMLDecodeError as error:
        raise InputError(str(path), f"is not TOML ({error})", "correct that line") from None
    except msgspec.ValidationError as error:
        raise _explained(path, error) from None


def _explained(path: Path, error: msgspec.ValidationError) -> InputError:
    message, _, place = str(error).partition(" - at `$")
    key = place.rstrip("`").lstrip(".") or "top level"
    if unknown := re.search(r"unknown field `(.+)`", message):
        name = unknown[1] if key == "top level" else f"{key}.{unknown[1]}"
        return InputError(str(path), f"unknown key {name}", "remove it or correct its spelling")
    if missing := re.search(r"missing required field `(.+)`", message):
        name = missing[1] if key == "top level" else f"{key}.{missing[1]}"
        return InputError(str(path), f"missing key {name}", "add it")
    return InputError(str(path), f"{key}: {message}", "correct that value")
