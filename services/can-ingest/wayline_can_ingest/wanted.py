"""Pure: which frames of a bus are worth reading, as the mapping says."""

from collections.abc import Iterable
from typing import NotRequired, TypedDict

from wayline.inputs import Frame
from wayline_can_ingest.j1939 import is_addressed, pgn_of
from wayline_can_ingest.mapping import FrameKey, Mapping

STANDARD_MASK = 0x7FF
EXTENDED_MASK = 0x1FFF_FFFF
BROADCAST_MASK = 0x03FF_FF00
"""The PGN of an identifier whose destination is everybody (PDU2)."""
ADDRESSED_MASK = 0x03FF_0000
"""The PGN of an identifier that holds its destination (PDU1)."""
TRANSPORT_PGNS = frozenset((0xEC00, 0xEB00))
"""J1939-21 TP.CM and TP.DT, which carry messages of more than 8 bytes."""
MOST_FILTERS = 512
"""Linux refuses more for a socket (CAN_RAW_FILTER_MAX); a bus that needs more is read whole."""


class Filter(TypedDict):
    """As python-can's interfaces take it."""

    can_id: int
    can_mask: int
    extended: NotRequired[bool]


class Wanted:
    """The identifiers that are mapped, for a look-up and as filters of kernel or adapter."""

    def __init__(self, mapping: Mapping, extra: Iterable[Filter] = ()) -> None:
        self._find = mapping.find
        keys = set(mapping.plans)
        if mapping.pgns:
            keys |= {FrameKey(pgn, True, True) for pgn in TRANSPORT_PGNS}
        self._has_transport = bool(mapping.pgns)
        filters = [*map(_filter, sorted(keys)), *extra]
        self.filters = filters if 0 < len(filters) <= MOST_FILTERS else None
        """As python-can takes them; None where everything has to be read."""

    def has(self, frame: Frame) -> bool:
        """Whether a frame is mapped, or part of a message that may be."""
        if self._find(frame.arbitration_id, frame.extended):
            return True
        is_part = self._has_transport and frame.extended
        return is_part and pgn_of(frame.arbitration_id) in TRANSPORT_PGNS


class Everything(Wanted):
    """In place of a mapping, for who looks at a bus: nothing is left out."""

    def __init__(self) -> None:
        self.filters = None

    def has(self, frame: Frame) -> bool:
        """Every frame is."""
        del frame
        return True


def _filter(key: FrameKey) -> Filter:
    if not key.is_pgn:
        mask = EXTENDED_MASK if key.extended else STANDARD_MASK
        return {"can_id": key.number, "can_mask": mask, "extended": key.extended}
    mask = ADDRESSED_MASK if is_addressed(key.number) else BROADCAST_MASK
    return {"can_id": key.number << 8, "can_mask": mask, "extended": True}
