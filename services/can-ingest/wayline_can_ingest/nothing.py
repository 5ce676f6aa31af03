"""Why no message came of a recorded bus, and how to mend it."""

from itertools import islice

from wayline.can_log import OTHER_CHANNEL, OWN, CanLog
from wayline.drive import CanSource
from wayline.errors import InputError
from wayline_can_ingest.mapping import Mapping

LOOKED_AT = 2_000
"""Frames whose identifiers are named where none of them is mapped."""
NAMED = 8


def no_frames(log: CanLog) -> InputError:
    """Why a log that could be read gave no frame."""
    files = ", ".join(map(str, log.paths))
    if log.left_out[OTHER_CHANNEL]:
        there = ", ".join(repr(name) if name else "none" for name in sorted(log.channels))
        mend = f"give one of its channels ({there}), or leave channel out"
        return InputError(files, "holds no frame on that channel", mend)
    if log.left_out[OWN]:
        what = f"{log.left_out[OWN]:,} frames sent by the logger itself (Tx) left out, no others"
        return InputError(files, what, "take them by own_frames = true in its [[can]]")
    left = ", ".join(log.leaves_out) or "none that can be one"
    return InputError(files, f"holds no data frames ({left})", "record a live bus")


def nothing_mapped(source: CanSource, mapping: Mapping, mapped: int, where: str) -> InputError:
    """Why frames gave no message, so many of which are mapped."""
    files = ", ".join(source.paths)
    if mapped:
        what = f"{mapped:,} frames are mapped, none of them holds a mapped signal"
        return InputError(files, what, "check that the dbc is this vehicle's")
    if not mapping.plans:
        mend = "add [can.signals]; wayline doctor can --log FILE --dbc FILE proposes them"
        return InputError(where, "its [[can]] maps nothing", mend)
    frames = islice(CanLog.of(source), LOOKED_AT)
    seen = sorted({(frame.extended, frame.arbitration_id) for frame in frames})
    names = ", ".join(f"{number:0{8 if extended else 3}X}" for extended, number in seen[:NAMED])
    more = ", ..." if len(seen) > NAMED else ""
    return InputError(
        files,
        f"none of its frames is mapped (it has {names}{more})",
        "check the dbc and its identifiers, and j1939 = true for a truck; "
        "wayline doctor can --log FILE says what fits",
    )


def clock_never_told(source: CanSource) -> InputError:
    """A clock signal that was never valid holds everything back."""
    clock = "" if source.clock is None else f"{source.clock.message}.{source.clock.signal}"
    files = ", ".join(source.paths)
    mend = "correct clock, or give clock_offset_s"
    return InputError(files, f"its clock {clock} never told the time", mend)
