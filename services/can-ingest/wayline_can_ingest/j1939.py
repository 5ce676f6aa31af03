"""Pure: how SAE J1939 writes identifiers and what a field says that has no value."""

ERROR_TOP = 0xFE
"""J1939-71 5.1.4: a top byte of FEh is "error", FFh "not available"."""
LAST_COUNT_TOP = 0xFB
"""J1939-71 5.1.4: a top byte beyond FBh is no value, so a counter begins again after it."""
BROADCAST_FORMAT = 0xF0
"""J1939-21 5.2: from this PDU format on a message is for everybody."""


def pgn_of(identifier: int) -> int:
    """Parameter group number of a 29-bit identifier, without priority, source, destination."""
    pgn = (identifier >> 8) & 0x3FFFF
    return pgn & 0x3FF00 if is_addressed(pgn) else pgn


def is_addressed(pgn: int) -> bool:
    """Whether messages of this group are sent to one address (PDU1)."""
    return (pgn >> 8) & 0xFF < BROADCAST_FORMAT


def identifier_of(pgn: int, source: int, destination: int, priority: int = 6) -> int:
    """The 29-bit identifier of a message."""
    addressed = pgn | destination if is_addressed(pgn) else pgn
    return priority << 26 | addressed << 8 | source


def least_not_available(length_bits: int) -> int:
    """From this raw value on a field, of bits or of bytes, says "error" or "not available"."""
    if length_bits >= 8:
        return ERROR_TOP << (length_bits - 8)
    # one bit has no room to say so
    return (1 << length_bits) - 2 if length_bits >= 2 else 2


def not_available(raw: float, length_bits: int) -> bool:
    """Whether a raw value means "not available" or "error"; a signed one by its bits."""
    return int(raw) & ((1 << length_bits) - 1) >= least_not_available(length_bits)


def counter_turns(length_bits: int) -> int:
    """Raw value at which a counter begins again at 0."""
    return LAST_COUNT_TOP << (length_bits - 8) if length_bits >= 8 else (1 << length_bits) - 2
