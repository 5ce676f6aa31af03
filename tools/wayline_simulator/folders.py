"""Asks before files of the user are written over."""

import sys
from pathlib import Path

import typer

from wayline.errors import InputError


def check_empty(out: Path) -> None:
    """Asks on a terminal whether files may be overwritten; elsewhere they may not."""
    if not out.is_dir() or next(out.iterdir(), None) is None:
        return
    question = f"{out} has files; write the drive over and beside them?"
    if not sys.stdin.isatty() or not typer.confirm(question):
        raise InputError(str(out), "has files already", "name an empty folder, or give --force")
