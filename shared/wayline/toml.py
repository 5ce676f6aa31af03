"""Reads TOML files."""

import tomllib
from pathlib import Path
from typing import Any

from wayline.errors import InputError
from wayline.strict import StructType, fitted


def load_toml(path: Path, struct: type[StructType]) -> StructType:
    """Read `path` into `struct`, or raise InputError naming the file, the key and the mend."""
    return fitted(read_toml(path), struct, str(path))


def read_toml(path: Path) -> dict[str, Any]:
    """The tables of a file, or raise InputError."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except FileNotFoundError:
        raise InputError(str(path), "no such file", "check the path") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), f"cannot be read ({error})", "check the file") from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(str(path), f"is not TOML ({error})", "correct that line") from None
