"""Files for a library that opens them by name and unpacks nothing itself."""

import io
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import NamedTemporaryFile

from wayline.errors import InputError
from wayline.log_file import LogFile


@contextmanager
def plain_copy(path: Path) -> Iterator[Path]:
    """A copy of a file, unpacked where it is packed, as long as it is needed.

    RTKLIB takes a name's ending for a packing and calls other programs for it: the copy's tells
    it nothing. Raises InputError where the file cannot be read.
    """
    with NamedTemporaryFile(suffix=".rnx") as copy:
        try:
            with LogFile(path) as log, io.BufferedReader(log) as file:
                shutil.copyfileobj(file, copy)
        except OSError as error:
            what = f"cannot be read ({error.strerror or error})"
            raise InputError(str(path), what, "check the file") from None
        copy.flush()
        yield Path(copy.name)
