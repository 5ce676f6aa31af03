"""Reading CAN recordings: what is left out, what is counted, what is refused."""

import gzip
from pathlib import Path

import pytest

from wayline.can_log import CanLog
from wayline.errors import InputError
from wayline.inputs import Frame

LINES = """(1.000000) can0 100#0102
(1.010000) can0 12345678#AA
(1.020000) can0 100#0304 T
(1.030000) can0 100#R2
(1.040000) can0 garbage
(1.050000) can1 100#0506
"""


def test_frames_come_in_order_without_own_and_remote_ones(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text(LINES, encoding="ascii")
    log = CanLog([path])
    assert list(log) == [
        Frame(1_000_000_000, "can0", 0x100, False, b"\x01\x02"),
        Frame(1_010_000_000, "can0", 0x12345678, True, b"\xaa"),
        Frame(1_050_000_000, "can1", 0x100, False, b"\x05\x06"),
    ]


def test_a_damaged_line_is_counted_and_the_rest_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text(LINES, encoding="ascii")
    log = CanLog([path])
    assert list(log)[-1].channel == "can1"
    assert log.bad_input == 1


def test_several_recordings_follow_each_other_also_compressed(tmp_path: Path) -> None:
    plain, packed = tmp_path / "a.log", tmp_path / "b.log.gz"
    plain.write_text("(1.0) can0 100#01\n", encoding="ascii")
    packed.write_bytes(gzip.compress(b"(2.0) can0 100#02\n"))
    assert [frame.data for frame in CanLog([plain, packed])] == [b"\x01", b"\x02"]


def test_only_the_named_channel_is_read_and_the_others_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text("(1.0) can0 100#01\n(2.0) can1 100#02\n", encoding="ascii")
    log = CanLog([path], channel="can1")
    assert [frame.data for frame in log] == [b"\x02"]
    assert log.left_out == {"on another channel": 1}
    assert log.channels == {"can0": 1, "can1": 1}


@pytest.mark.parametrize(
    ("name", "content", "mend"),
    [
        ("a.xyz", b"1", "give a CAN recording"),
        ("a.mf4", b"not MDF", "give a CAN recording"),
        ("a.log.gz", b"not gzip", "give a CAN recording"),
        ("missing.log", None, "check the path"),
    ],
)
def test_what_is_no_recording_is_refused(
    tmp_path: Path, name: str, content: bytes | None, mend: str
) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=mend):
        list(CanLog([path]))
