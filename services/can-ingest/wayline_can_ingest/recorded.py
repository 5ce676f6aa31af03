"""The buses of a recorded drive, as bus messages."""

from pathlib import Path

from wayline.can_log import CanLog
from wayline.drive import CanSource, Drive, Vehicle
from wayline.received import Recording, source_names, translated
from wayline_can_ingest.configured import load_mapping
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.utc import DriveClock


def recordings(drive: Drive, where: str) -> list[Recording]:
    """Every `[[can]]` of a drive; `where` names its file in errors. Raises InputError."""
    names = source_names("can-ingest")
    told = _told_clock(drive, where)
    return [_bus(can, drive.vehicle, where, next(names), told) for can in drive.can]


def _told_clock(drive: Drive, where: str) -> DriveClock | None:
    """What the drive's first clock signal says: it holds for the buses without their own."""
    first = next((can for can in drive.can if can.clock is not None), None)
    if first is None or len(drive.can) == 1:
        return None
    core = _core(first, drive.vehicle, where, clock := DriveClock(None))
    for frame in _log(first):
        core.handle(frame, "can-ingest")
        if clock.offset_ns is not None:
            return clock
    return None


def _bus(
    source: CanSource, vehicle: Vehicle, where: str, name: str, told: DriveClock | None
) -> Recording:
    has_own = source.clock is not None or source.clock_offset_s != 0.0
    core = _core(source, vehicle, where, DriveClock.of(source) if has_own else told)
    log = _log(source)
    messages = translated(log, core.handle, name, lambda frame, _: core.received_ns(frame))
    return Recording(name, messages, lambda: core.bad_input + core.dropped + log.bad_input)


def _core(
    source: CanSource, vehicle: Vehicle, where: str, clock: DriveClock | None
) -> CanIngestCore:
    mapping = load_mapping(source, vehicle, where)
    return CanIngestCore(source, mapping, vehicle, channel=source.channel, clock=clock)


def _log(source: CanSource) -> CanLog:
    return CanLog([Path(path) for path in source.paths])
