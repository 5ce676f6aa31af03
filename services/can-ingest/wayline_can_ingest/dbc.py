"""Loads CAN databases with cantools; what does not load is one clear error."""

import logging
from collections.abc import Sequence
from pathlib import Path

import cantools
from cantools.database.can import Database

from wayline.errors import InputError
from wayline.log_file import decoded

# who maps one of several messages of a name is told so by the directory
logging.getLogger("cantools").setLevel(logging.ERROR)
TEXTS = {".dbc": "dbc", ".sym": "sym"}
"""Formats without a word on their encoding: cantools takes them for cp1252, marks and all."""
LONGEST = 200
"""Characters of cantools' reason: of a file of another kind it quotes the whole line."""


def load_databases(paths: Sequence[Path]) -> list[Database]:
    """Every database of a source, in order; overlapping signals are tolerated."""
    return [load_database(path) for path in paths]


def load_database(path: Path) -> Database:
    """One database (DBC, KCD, SYM, ARXML ...), or InputError with the file and the place."""
    mend = "correct the file or name another"
    try:
        kind = TEXTS.get(path.suffix.lower())
        if kind is None:
            database = cantools.database.load_file(path, strict=False)
        else:
            text = decoded(path.read_bytes())
            database = cantools.database.load_string(text, kind, strict=False)
    except FileNotFoundError:
        raise InputError(str(path), "no such file", "check the path") from None
    except (cantools.Error, ValueError, OSError) as error:
        raise InputError(str(path), f"is no CAN database ({_reason(error)})", mend) from None
    if not isinstance(database, Database):
        raise InputError(str(path), "is a diagnostics database", "name a CAN database")
    return database


def _reason(error: Exception) -> str:
    """One line that a terminal can show."""
    said = " ".join(str(error).split())
    shown = "".join(each if each.isprintable() else "?" for each in said)
    return shown if len(shown) <= LONGEST else f"{shown[:LONGEST]}..."
