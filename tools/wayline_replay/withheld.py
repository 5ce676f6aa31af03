"""Pure: what a drive's sources keep to themselves, to see how a vehicle is followed by the rest."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Literal, get_args

import msgspec

from wayline.errors import InputError
from wayline.messages import Barometer, GpsFix, Gyro, Odometer, Torque
from wayline.received import Received

Part = Literal["can", "gyro", "course", "speed"]
OF_CAN = (Odometer, Gyro, Torque, Barometer)
EARLY_S = 0.05
"""Receivers keep their interval to within so much."""


class Withheld(msgspec.Struct, frozen=True):
    """What is not passed on."""

    fixes_every_s: float = 0.0
    """Of each receiver the fixes that come sooner after the last one passed on."""
    parts: tuple[Part, ...] = ()
    """Of the vehicle all that CAN tells, or the gyro; of fixes the course, or course and speed."""


NOTHING = Withheld()


def withheld_of(text: str | None) -> Withheld:
    """What `--without` names, with commas between. Raises InputError."""
    known: tuple[Part, ...] = get_args(Part)
    wanted = [] if text is None else [name.strip() for name in text.split(",")]
    if unknown := [name for name in wanted if name not in known]:
        mend = f"give some of {', '.join(known)}"
        raise InputError("--without", f"{unknown[0]!r} cannot be withheld", mend)
    return Withheld(parts=tuple(name for name in known if name in wanted))


def without(messages: Iterable[Received], withheld: Withheld) -> Iterator[Received]:
    """What is left of a drive's messages."""
    passed_ns: dict[str, int] = {}
    least_ns = round((withheld.fixes_every_s - EARLY_S) * 1e9)
    for received in messages:
        message = received.message
        if isinstance(message, GpsFix):
            last_ns = passed_ns.get(received.source)
            if last_ns is not None and message.t_ns - last_ns < least_ns:
                continue
            if message.valid:
                passed_ns[received.source] = message.t_ns
            yield received._replace(message=_reduced(message, withheld.parts))
        elif not _is_withheld(message, withheld.parts):
            yield received


def _is_withheld(message: msgspec.Struct, parts: Sequence[Part]) -> bool:
    kinds = OF_CAN if "can" in parts else (Gyro,) if "gyro" in parts else ()
    return isinstance(message, kinds)


def _reduced(fix: GpsFix, parts: Sequence[Part]) -> GpsFix:
    if "speed" in parts:
        blank = {"speed_mps": None, "speed_std_mps": None, "speed_derived": False}
        fix = msgspec.structs.replace(fix, **blank)
    if "speed" in parts or "course" in parts:
        fix = msgspec.structs.replace(fix, course_deg=None, course_std_deg=None)
    return fix
