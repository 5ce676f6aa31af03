"""Pure: how other systems' names of vehicles become vehicle ids (SPEC section 3)."""

import re

from wayline.drive import VEHICLE_ID_PATTERN

NOT_ALLOWED = re.compile(r"[^a-z0-9_-]")
ID = re.compile(VEHICLE_ID_PATTERN)


def vehicle_id_of(name: str) -> str | None:
    """The id of a vehicle that another system calls so; None where nothing of the name can be one.

    Lower case, with `-` for what is not allowed: `Bus 12/A` is `bus-12-a`.
    """
    told = NOT_ALLOWED.sub("-", name.strip().lower()).lstrip("-_")
    return told if ID.match(told) else None
