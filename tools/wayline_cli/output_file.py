"""Where a command writes what it was asked for: a file, or stdout."""

import os
import sys
from pathlib import Path
from typing import BinaryIO

from wayline.errors import InputError


def binary_output(path: Path | None) -> BinaryIO:
    """A file to write, stdout without a path; closing it leaves stdout open. Raises InputError."""
    if path is None:
        return os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    try:
        return path.open("wb")
    except OSError as error:
        what = f"cannot be written ({error.strerror})"
        raise InputError(str(path), what, "name a file in a folder that exists") from None
