"""Why no message came of a recorded bus, and how to mend it."""

from itertools import islice

from wayline.can_log import OTHER_CHANNEL, OWN, CanLog
from wayline.drive import CanSource
from wayline.errors import InputError
from wayline_can_ingest.core import CanIngestCore

LOOKED_AT = 2_000
"""Frames whose identifiers are named where none of them is mapped."""
NAMED = 8


def nothing_read(source: CanSource, log: CanLog, core: CanIngestCore, where: str) -> InputError:
    """What was seen of a bus instead, once it was read to its end."""
    files = ", ".join(source.paths)
    if not log.frames:
        return no_frames(files, log)
    if core.mapped and source.clock is not None and core.has_no_time:
        signal = f"{source.clock.message}.{source.clock.signal}"
        mend = "correct clock, or give clock_offset_s"
        return InputError(files, f"its clock {signal} never told the time", mend)
    if core.mapped:
        what = f"{core.mapped:,} frames are mapped, none of them holds a mapped signal"
        return InputError(files, what, "check that the dbc is this vehicle's")
    if not (source.signals or core.has_plans):
        mend = "add [can.signals]; wayline doctor can --log FILE --dbc FILE proposes them"
        return InputError(where, "its [[can]] maps nothing", mend)
    frames = islice(CanLog.of(source), LOOKED_AT)
    seen = sorted({(frame.extended, frame.arbitration_id) for frame in frames})
    names = ", ".join(f"{number:0{8 if extended else 3}X}" for extended, number in seen[:NAMED])
    more = ", ..." if len(seen) > NAMED else ""
    return InputError(
        files,
        f"none of its {log.frames:,} frames is mapped (it has {names}{more})",
        "check the dbc and its identifiers, channel, and j1939 = true for a truck; "
        "wayline doctor can --log FILE says what fits",
    )


def no_frames(files: str, log: CanLog) -> InputError:
    """Why a log that could be read gave no frame."""
    if log.left_out[OTHER_CHANNEL]:
        there = ", ".join(repr(name) if name else "none" for name in sorted(log.channels))
        mend = f"give one of its channels ({there}), or leave channel out"
        return InputError(files, "holds no frame on that channel", mend)
    if log.left_out[OWN]:
        what = f"{log.left_out[OWN]:,} frames sent by the logger itself (Tx) left out, no others"
        return InputError(files, what, "take them by own_frames = true in its [[can]]")
    left = ", ".join(log.leaves_out)
    return InputError(
        files, f"holds no data frames ({left or 'none that can be one'})", "record a live bus"
    )
