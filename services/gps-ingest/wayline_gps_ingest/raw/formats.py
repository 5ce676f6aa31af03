"""What kind of raw measurements a file holds: as its table says, else by its first bytes."""

from pathlib import Path

from wayline.drive import RawFormat, RawSource
from wayline.errors import InputError
from wayline.log_file import head_of
from wayline_gps_ingest.raw.ubx_frames import SYNC

RINEX, HATANAKA = b"RINEX VERSION / TYPE", b"CRINEX VERS   / TYPE"
OBSERVATIONS = b"O"
"""RINEX's letter for them, in the first line's 21st column."""
READABLE = "give u-blox UBX, a RINEX observation file, or a CSV with columns"


def format_of(source: RawSource) -> RawFormat:
    """The format of a `[[raw]]`. Raises InputError for what is none, or not what it is said."""
    if source.format == "csv" or (source.format is None and source.columns is not None):
        if source.columns is None:
            raise InputError(source.path, "no columns are named", "add columns to its [[raw]]")
        return "csv"
    found = _found(Path(source.path))
    if source.format not in {None, found}:
        what = f"is no {source.format}, but {found}"
        raise InputError(source.path, what, "correct format in its [[raw]], or leave it out")
    return found


def _found(path: Path) -> RawFormat:
    head = head_of(path)
    first = head.split(b"\n", 1)[0]
    if HATANAKA in first:
        mend = "unpack it with crx2rnx"
        raise InputError(str(path), "is RINEX packed by Hatanaka's scheme", mend)
    if RINEX in first:
        if first[20:21] != OBSERVATIONS:
            mend = "name the observation file, and this one in nav = [...]"
            raise InputError(str(path), "is RINEX, but no observations", mend)
        return "rinex"
    if SYNC in head:
        return "ubx"
    raise InputError(str(path), "holds no raw measurements that are known", READABLE)
