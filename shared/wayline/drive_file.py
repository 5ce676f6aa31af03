"""Reads a drive's `drive.toml`; its recordings are read by the ingest services (`recorded.py`)."""

from pathlib import Path

import msgspec

from wayline.drive import Drive, PathRef, RouteRef
from wayline.errors import InputError
from wayline.profile import with_profiles
from wayline.strict import fitted
from wayline.toml import read_toml


def load_drive(folder: Path) -> Drive:
    """Read the drive in a folder (or its `drive.toml`), every path made absolute and there.

    Raises InputError for a missing file, an unknown key or a drive without input.
    """
    path = folder if folder.suffix == ".toml" else folder / "drive.toml"
    if not path.exists():
        raise InputError(str(folder), "no drive.toml there", "name a drive's folder")
    drive = fitted(with_profiles(read_toml(path), str(path)), Drive, str(path))
    if not (drive.nmea or drive.can or drive.avl or drive.raw):
        raise InputError(str(path), "no input", "add a [[nmea]], [[can]], [[avl]] or [[raw]] table")
    for position, can in enumerate(drive.can, start=1):
        if not can.paths:
            raise InputError(f"{path} [[can]] {position}", "path is empty", "name a recording")

    def found(name: str, *, may_be_folder: bool = False) -> str:
        resolved = path.parent / name
        if not (resolved.is_file() or (may_be_folder and resolved.is_dir())):
            raise InputError(str(path), f"file {name} is missing", "correct the path or add it")
        return str(resolved)

    def located(ref: PathRef | None) -> PathRef | None:
        return PathRef(path=found(ref.path)) if ref else None

    replace = msgspec.structs.replace
    return replace(
        drive,
        nmea=tuple(replace(nmea, path=found(nmea.path)) for nmea in drive.nmea),
        can=tuple(
            replace(
                can,
                path=tuple(found(name) for name in can.paths),
                dbc=tuple(found(name) for name in can.dbc),
            )
            for can in drive.can
        ),
        avl=tuple(
            replace(avl, path=found(avl.path, may_be_folder=avl.columns is None))
            for avl in drive.avl
        ),
        raw=tuple(
            replace(raw, path=found(raw.path), nav=tuple(found(name) for name in raw.navs))
            for raw in drive.raw
        ),
        route=RouteRef(path=tuple(map(found, drive.route.paths))) if drive.route else None,
        truth=located(drive.truth),
    )
