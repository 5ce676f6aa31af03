"""Recordings cut short or zeroed by a power loss, in every format, at every place."""

from pathlib import Path

import pytest

from can_files import COUNT, FORMATS, TEXTS, recording
from wayline.can_log import CanLog
from wayline.errors import UnreadableError
from wayline.inputs import Frame

SLOW = ("mf4",)
"""Each reading is a process; every byte of them is for `scripts/siege files`."""
UNPACKED = UNORDERED = ("db",)
EVERYWHERE = [
    (kind, packed)
    for kind in FORMATS
    for packed in (False, True)
    if kind not in SLOW and not (packed and kind in UNPACKED)
]
BLOCK = 8
LARGE = 2000
"""Bytes; of a longer file not every one is tried."""


def read(path: Path) -> tuple[list[Frame], int]:
    """Frames of a recording and how much of it was damaged; what is refused has none."""
    log = CanLog([path], own_frames=True)
    try:
        return list(log), log.bad_input
    except UnreadableError:
        return [], 1


def ends_of_frames(kind: str, data: bytes) -> list[int]:
    """Where in a text each frame's line ends."""
    ends = [at + 1 for at, byte in enumerate(data) if byte == ord("\n")]
    if kind == "asc":
        return ends[-COUNT - 1 : -1]  # End TriggerBlock
    return ends[-COUNT:]


@pytest.mark.parametrize(("kind", "packed"), EVERYWHERE)
def test_what_is_before_a_cut_is_kept(kind: str, packed: bool, tmp_path: Path) -> None:
    """At every byte: no other exception than a refusal, no frame that was not there."""
    path = recording(kind, tmp_path, packed=packed)
    data = path.read_bytes()
    whole, damaged = read(path)
    assert (len(whole), damaged) == (COUNT, 0)
    for end in range(0, len(data), 1 if len(data) < LARGE else len(data) // LARGE):
        path.write_bytes(data[:end])
        kept, _ = read(path)
        if kind not in UNORDERED:
            assert all(same(frame, other) for frame, other in zip(kept, whole, strict=False)), end
        if kind in TEXTS and not packed:
            assert len(kept) >= sum(each <= end for each in ends_of_frames(kind, data)), end


@pytest.mark.parametrize("kind", TEXTS)
def test_a_zeroed_line_costs_itself_alone(kind: str, tmp_path: Path) -> None:
    """Every block of 8 bytes behind the header: a line, two where it held the end of one."""
    path = recording(kind, tmp_path)
    data = path.read_bytes()
    whole, _ = read(path)
    first = ends_of_frames(kind, data)[0]
    for at in range(-(-first // BLOCK) * BLOCK, len(data) - BLOCK, BLOCK):
        path.write_bytes(data[:at] + bytes(BLOCK) + data[at + BLOCK :])
        kept, damaged = read(path)
        lost = [frame for frame in whole if frame not in kept]
        assert [frame for frame in whole if frame in kept] == kept, at
        assert len(lost) <= 2, at
        assert damaged > 0, at


@pytest.mark.parametrize(("kind", "packed"), EVERYWHERE)
def test_zeros_anywhere_are_no_traceback(kind: str, packed: bool, tmp_path: Path) -> None:
    """Header and binary formats too; of packed data only what is before the zeros is believed."""
    path = recording(kind, tmp_path, packed=packed)
    data = path.read_bytes()
    whole, _ = read(path)
    for at in range(0, len(data), BLOCK):
        path.write_bytes(data[:at] + bytes(BLOCK) + data[at + BLOCK :])
        kept, _ = read(path)
        assert len(kept) <= COUNT, at
        if packed and at > 0:
            assert all(same(frame, other) for frame, other in zip(kept, whole, strict=False)), at


def test_a_damaged_mf4_is_one_line_or_frames(tmp_path: Path) -> None:
    """Cut and zeroed at some places: its reader is a process of its own."""
    path = recording("mf4", tmp_path)
    data = path.read_bytes()
    whole, damaged = read(path)
    assert (len(whole), damaged) == (COUNT, 0)
    for at in range(len(data) // 5, len(data), len(data) // 5):
        path.write_bytes(data[:at])
        kept, _ = read(path)
        assert kept == whole[: len(kept)], at
        path.write_bytes(data[:at] + bytes(BLOCK) + data[at + BLOCK :])
        assert len(read(path)[0]) in (0, COUNT), at


def same(frame: Frame, other: Frame) -> bool:
    """A cut may leave of a line's data only the beginning."""
    return frame == other or (
        frame.t_ns == other.t_ns
        and frame.arbitration_id == other.arbitration_id
        and other.data.startswith(frame.data)
    )
