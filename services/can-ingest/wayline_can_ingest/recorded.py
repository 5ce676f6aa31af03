"""The buses of a recorded drive, as bus messages."""

from pathlib import Path

from wayline.arrival import Recording, source_names, translated
from wayline.can_log import CanLog
from wayline.drive import CanSource, Drive, Vehicle
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.dbc import load_databases
from wayline_can_ingest.mapping import compile_mapping


def recordings(drive: Drive, where: str) -> list[Recording]:
    """Every `[[can]]` of a drive; `where` names its file in errors. Raises InputError."""
    names = source_names("can-ingest")
    return [_bus(can, drive.vehicle, where, next(names)) for can in drive.can]


def _bus(source: CanSource, vehicle: Vehicle, where: str, name: str) -> Recording:
    databases = load_databases([Path(path) for path in source.dbc])
    mapping = compile_mapping(source, databases, vehicle, where)
    core = CanIngestCore(source, mapping, vehicle, channel=source.channel)
    log = CanLog([Path(path) for path in source.paths])
    messages = translated(log, core.handle, name, lambda frame, _: core.arrival_ns(frame))
    return Recording(name, messages, lambda: core.bad_input + core.dropped + log.bad_input)
