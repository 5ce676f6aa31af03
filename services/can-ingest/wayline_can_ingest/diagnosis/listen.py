"""Listens to a CAN bus for a while, or polls it; reads the beginning of a recording."""

import itertools
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import msgspec

from wayline.can_log import CanLog
from wayline.inputs import Frame
from wayline.live_sources import LiveCan
from wayline_can_ingest.bus_reader import NOT_TRIED
from wayline_can_ingest.diagnosis.opening import not_opened
from wayline_can_ingest.frames import ERROR
from wayline_can_ingest.interfaces import Interface
from wayline_can_ingest.nothing import no_frames
from wayline_can_ingest.obd2_poll import Obd2Poll
from wayline_can_ingest.wanted import Everything

MOST_FRAMES = 500_000
"""Two minutes of a full 500 kbit/s bus: enough of a recording to judge by."""
LOOK_S = 0.1


class Heard(NamedTuple):
    """Frames, and what is known of where they come from."""

    frames: Sequence[Frame]
    note: str = ""
    """How the link or the polling does; empty where there is nothing to say."""
    mend: str = ""


def heard_on(source: LiveCan, seconds: float) -> Heard:
    """Frames of a live bus. Raises InputError where it does not open."""
    frames: list[Frame] = []

    def put(given: msgspec.Struct) -> None:
        if isinstance(given, Frame) and len(frames) < MOST_FRAMES:
            frames.append(given)

    bus = Interface("doctor", source, Everything(), polls=bool(source.obd2))
    stop = threading.Event()
    reading = threading.Thread(target=bus.run, args=(put, stop), daemon=True)
    reading.start()
    try:
        _await_open(bus, source)
        until_s = time.monotonic() + seconds
        while time.monotonic() < until_s and len(frames) < MOST_FRAMES:
            time.sleep(LOOK_S)
        note = _note(bus)
    finally:
        stop.set()
        reading.join()
    is_heard = any(map(Obd2Poll.is_reply, frames)) if source.obd2 else bool(frames)
    return Heard(tuple(frames), note, "" if is_heard else _mend(source, bus.faults))


def _await_open(bus: Interface, source: LiveCan) -> None:
    """Serial adapters take seconds. Raises InputError where it does not open."""
    while (error := bus.condition.link_error) == NOT_TRIED:
        time.sleep(LOOK_S)
    if error is not None:
        raise not_opened(source, error)


def _note(bus: Interface) -> str:
    condition = bus.condition
    faults = (f"{times} {reason}" for reason, times in sorted(condition.faults.items()))
    return ", ".join(filter(None, (condition.problem, condition.note, *faults)))


def _mend(source: LiveCan, faults: Mapping[str, int]) -> str:
    """What to look at where not a frame came, or not a reply."""
    if faults.get(ERROR):
        return "only errors: another bitrate, or CAN high and low swapped"
    if source.obd2:
        return "ignition on? bitrate (500000, older cars 250000)? pins 6 and 14?"
    return "ignition on? wiring, bitrate; behind a gateway OBD-II has to be asked: --obd2"


def heard_in(paths: Sequence[Path]) -> Heard:
    """The first frames of a recording. Raises InputError where there are none."""
    log = CanLog(paths)
    frames = tuple(itertools.islice(log, MOST_FRAMES))
    if not frames:
        raise no_frames(log)
    notes = [str(problem) for problem in log.problems]
    if len(frames) == MOST_FRAMES:
        notes.append(f"its first {MOST_FRAMES:,} frames")
    if log.bad_input:
        notes.append(f"{log.bad_input} damaged lines or endings left out")
    if log.left_out:
        notes.append(f"{', '.join(log.leaves_out)} left out")
    return Heard(frames, ", ".join(notes))
