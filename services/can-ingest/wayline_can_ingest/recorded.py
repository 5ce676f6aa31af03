"""The buses of a recorded drive, as bus messages."""

from collections.abc import Iterable, Iterator
from contextlib import suppress

from wayline.can_log import CanLog
from wayline.drive import CanSource, Drive, Vehicle
from wayline.errors import InputError, UnreadableError
from wayline.inputs import Frame
from wayline.messages import EARLIEST_NS
from wayline.received import Account, Recording, source_names, translated
from wayline.times_ahead import TimesAhead, believed
from wayline_can_ingest.configured import load_mapping
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.mapping import Mapping
from wayline_can_ingest.nothing import clock_never_told, no_frames, nothing_mapped
from wayline_can_ingest.utc import DriveClock
from wayline_can_ingest.wanted import Wanted

HELD_MAX = 200_000
"""Frames: ten seconds of two full buses, and more than they take in memory is not worth it."""
UNDATED_FROM_S = 946_684_800
"""2000: where the times of a recording without a date begin that is a drive's only source."""


def recordings(drive: Drive, where: str) -> list[Recording]:
    """Every `[[can]]` of a drive; `where` names its file in errors. Raises InputError."""
    names = source_names("can-ingest")
    clocks = [_clock(can, drive.vehicle, where) for can in drive.can]
    _check_dates(drive)
    # what the first clock signal says holds for the buses without a clock of their own
    told = (clock for clock in clocks if clock is not None and clock.offset_ns is not None)
    first = next(told, None)
    return [
        _bus(can, drive.vehicle, where, next(names), clock or first)
        for can, clock in zip(drive.can, clocks, strict=True)
    ]


def _clock(source: CanSource, vehicle: Vehicle, where: str) -> DriveClock | None:
    """What a bus's clock signal says, which is read ahead of all else; None without one."""
    if source.clock is None:
        return None
    clock = DriveClock.of(source, doubts_start=True, clock_from_ns=EARLIEST_NS)
    core = CanIngestCore(source, load_mapping(source, vehicle, where), vehicle, clock=clock)
    with suppress(UnreadableError):  # said when it is its turn to be read
        for frame in Believed(CanLog.of(source)):
            core.handle(frame, "can-ingest")
            if clock.offset_ns is not None:
                return clock
    clock.settle()
    return clock


def _check_dates(drive: Drive) -> None:
    """Refuse recordings without a date beside sources that have one: they share no clock."""
    if any(can.clock is not None for can in drive.can):
        return
    others = len(drive.nmea) + len(drive.avl) + len(drive.raw)
    paths = [path for can in drive.can for path in can.paths]
    if others + len(paths) == 1:
        return
    logs = [CanLog.of(can) for can in drive.can if can.clock_offset_s == 0.0]
    undated = [path for log in logs for path in log.find_undated()]
    if undated and others + len(paths) > len(undated):
        raise InputError(
            ", ".join(map(str, undated)),
            "carries no date, which the drive's other sources do",
            "give its [[can]] date = YYYY-MM-DD (the day on which its times begin at midnight), "
            "clock_offset_s (Unix time less its own) or a clock signal",
        )


def _bus(
    source: CanSource, vehicle: Vehicle, where: str, name: str, told: DriveClock | None
) -> Recording:
    has_own = source.clock_offset_s != 0.0 and source.clock is None
    has_clock = has_own or told is not None
    mapping = load_mapping(source, vehicle, where)
    clock = DriveClock.of(source) if has_own else told
    core = CanIngestCore(source, mapping, vehicle, clock=clock)
    log = CanLog.of(source, undated_from_s=0 if has_clock else UNDATED_FROM_S)
    lasting = Believed(log)
    frames = Counted(lasting, mapping)
    messages = translated(frames, core.handle, name, lambda frame, _: core.received_ns(frame))

    def account() -> Account:
        left_out = dict(log.left_out)
        if frames.unmapped:
            left_out["not mapped"] = frames.unmapped
        return Account(left_out, _warnings(source, log, has_clock=has_clock))

    def nothing() -> InputError:
        mapped = log.frames - frames.unmapped
        if mapped and source.clock is not None and core.has_no_time:
            return clock_never_told(source)
        return nothing_mapped(source, mapping, mapped, where) if log.frames else no_frames(log)

    return Recording(
        name,
        messages,
        lambda: core.bad_input + core.dropped + log.bad_input + lasting.dropped,
        account,
        nothing,
    )


class Believed:
    """Passes frames on, but those of a time far ahead that did not last."""

    def __init__(self, frames: Iterable[Frame]) -> None:
        self._frames = frames
        self._ahead = TimesAhead[Frame](doubts_start=True, held_max=HELD_MAX)

    def __iter__(self) -> Iterator[Frame]:
        return believed(((frame.t_ns, frame) for frame in self._frames), self._ahead)

    @property
    def dropped(self) -> int:
        """Frames of a time that did not last."""
        return self._ahead.dropped


class Counted:
    """Passes frames on and counts those that the mapping does not ask for."""

    def __init__(self, frames: Iterable[Frame], mapping: Mapping) -> None:
        self._frames = frames
        self._wanted = Wanted(mapping)
        self.unmapped = 0

    def __iter__(self) -> Iterator[Frame]:
        for frame in self._frames:
            self.unmapped += not self._wanted.has(frame)
            yield frame


def _warnings(source: CanSource, log: CanLog, *, has_clock: bool) -> list[str]:
    warnings = [str(problem) for problem in log.problems]
    if log.own:
        files = ", ".join(source.paths)
        warnings.append(f"{files}: {log.own:,} frames taken that the logger sent itself (Tx)")
    if log.undated and not has_clock:
        files = ", ".join(map(str, log.undated))
        warnings.append(f"{files}: carries no date, its times count from the year 2000")
    return warnings
