"""Loads what the extra `raw` installs, where it is needed and nowhere else."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from wayline.errors import InputError
from wayline_gps_ingest.raw.core import RawIngestCore
from wayline_gps_ingest.raw.ephemerides import Placing

if TYPE_CHECKING:
    from wayline_gps_ingest.raw.broadcast import Broadcast
    from wayline_gps_ingest.raw.rinex import RinexLog
    from wayline_gps_ingest.raw.ubx_core import UbxCore
    from wayline_gps_ingest.raw.ubx_log import UbxLog

PACKAGES = {"pyrtklib5", "pyubx2"}


def broadcast(navs: Iterable[str], where: str) -> "Broadcast":
    """Ephemerides, with those of navigation files; `where` names what needs them.

    Raises InputError for a file without ephemerides, and where the packages are missing.
    """
    with _needed(where):
        from wayline_gps_ingest.raw.broadcast import Broadcast  # noqa: PLC0415 -- an extra
    ephemerides = Broadcast()
    for nav in navs:
        ephemerides.read(Path(nav))
    return ephemerides


def ubx_log(path: Path, placing: Placing, heard: "Broadcast | None") -> "UbxLog":
    """What reads a u-blox receiver's log; `heard`: what is to hear the satellites' messages.

    Raises InputError where packages are missing.
    """
    with _needed(str(path)):
        from wayline_gps_ingest.raw.ubx_log import UbxLog  # noqa: PLC0415 -- an extra
    return UbxLog(path, placing, heard)


def ubx_core(placing: Placing, heard: "Broadcast | None", epochs: RawIngestCore) -> "UbxCore":
    """What takes a live receiver's messages. Raises InputError where packages are missing."""
    with _needed("[[raw]]"):
        from wayline_gps_ingest.raw.ubx import UbxReceiver  # noqa: PLC0415 -- an extra
        from wayline_gps_ingest.raw.ubx_core import UbxCore  # noqa: PLC0415 -- an extra
    return UbxCore(UbxReceiver(placing, heard), epochs)


def rinex_log(path: Path, placing: Placing) -> "RinexLog":
    """What reads a RINEX observation file. Raises InputError where packages are missing."""
    with _needed(str(path)):
        from wayline_gps_ingest.raw.rinex import RinexLog  # noqa: PLC0415 -- an extra
    return RinexLog(path, placing)


@contextmanager
def _needed(where: str) -> Iterator[None]:
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name not in PACKAGES:
            raise
        what = f"needs the package {error.name}, which is not installed"
        raise InputError(where, what, 'pip install "wayline[raw]"') from None
