"""Makes drives of one table that holds many, by the values of a column: `wayline split`."""

import json
from pathlib import Path
from string import Template

from wayline.csv_file import CsvFile, Row
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.vehicle_ids import vehicle_id_of

PLACEHOLDERS = ("table", "value", "id")
"""In a template: the table's path, a drive's value in the column, and that as a vehicle id."""


def split_table(table: Path, column: str, template: Path, out: Path) -> list[Path]:
    """Write `out/<id>/drive.toml` for every value of the column, in order of appearance.

    The template is a `drive.toml` with `$table`, `$value` and `$id` in it. Raises InputError where
    there is no such column, two values become one id, or what is written is no drive.
    """
    text = _template(template)
    folders = []
    for name, value in _ids(table, column).items():
        folder = out / name
        written = text.substitute(
            table=_quoted(str(table.absolute())), value=_quoted(value), id=name
        )
        try:
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "drive.toml").write_text(written, encoding="utf-8")
        except OSError as error:
            reason = error.strerror or str(error)
            raise InputError(str(folder), reason, "name a folder that can be written") from None
        load_drive(folder)
        folders.append(folder)
    return folders


def _template(path: Path) -> Template:
    try:
        template = Template(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), f"cannot be read ({error})", "check the file") from None
    known = f"use {', '.join(f'${name}' for name in PLACEHOLDERS)}, and $$ for a dollar"
    if not template.is_valid():
        raise InputError(str(path), "a $ stands by itself", known)
    if unknown := sorted(set(template.get_identifiers()) - set(PLACEHOLDERS)):
        raise InputError(str(path), f"${unknown[0]} is not known", known)
    if "value" not in template.get_identifiers():
        mend = 'take a drive\'s rows with where = { column = "$value" }'
        raise InputError(str(path), "has no $value: all drives would be one", mend)
    return template


def _ids(table: Path, column: str) -> dict[str, str]:
    """The column's value by vehicle id."""
    rows = CsvFile(table).rows()
    header = next(rows, Row(1, [])).cells
    if column not in header:
        mend = f"name one of its columns: {', '.join(header) or 'none, the file is empty'}"
        raise InputError(str(table), f"no column {column}", mend)
    place = header.index(column)
    ids: dict[str, str] = {}
    for value in dict.fromkeys(row.cells[place] for row in rows if place < len(row.cells)):
        if not value:
            continue
        name = vehicle_id_of(value)
        if name is None:
            what = f"nothing of {value!r} in {column} can be a vehicle id"
            raise InputError(str(table), what, "rename it")
        if name in ids:
            what = f"{ids[name]!r} and {value!r} of {column} are both {name}"
            raise InputError(str(table), what, "rename one")
        ids[name] = value
    if not ids:
        raise InputError(str(table), f"no value in {column}", "name another column")
    return ids


def _quoted(text: str) -> str:
    """As it stands between the quotes of TOML, which escapes what JSON does."""
    return json.dumps(text, ensure_ascii=False)[1:-1]
