"""Databases as people have them: broken ones are one clear line, wherever they are read."""

from collections.abc import Callable
from pathlib import Path

import pytest

from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline_can_ingest.dbc import load_database
from wayline_can_ingest.recorded import recordings

Recorded = Callable[[str], Path]
WHOLE = {
    "_gearbox_common.dbc": 2,
    "_nidec_common.dbc": 5,
    "honda_civic_touring_2016_can.dbc": 2,
    "toyota_new_mc_pt.dbc": 3,
    "toyota_nodsu_pt.dbc": 5,
    "toyota_prius_2010_pt.dbc": 26,
}
BROKEN = {"_honda_common.dbc": "line 207", "toyota_2017_ref_pt.dbc": "message BDB1F01_14"}


def drive_with(dbc: Path, folder: Path, signals: str = "") -> Path:
    """A drive with a recording and a database."""
    (folder / "drive.log").write_text("(1.0) can0 100#1027\n")
    (folder / "drive.toml").write_text(
        f'[drive]\nvehicle_id = "a"\n[[can]]\npath = "drive.log"\ndbc = ["{dbc}"]\n{signals}'
    )
    return folder


@pytest.mark.parametrize(("name", "messages"), WHOLE.items())
def test_whole_databases_load(recorded: Recorded, name: str, messages: int) -> None:
    """Parts of others among them."""
    assert len(load_database(recorded("dbc") / name).messages) == messages


@pytest.mark.parametrize(("name", "place"), BROKEN.items())
def test_a_drive_with_a_broken_database_is_refused_in_one_line(
    recorded: Recorded, tmp_path: Path, name: str, place: str
) -> None:
    """With the file and the place in it."""
    path = recorded("dbc") / name
    drive = load_drive(drive_with(path, tmp_path))
    with pytest.raises(InputError) as refused:
        recordings(drive, "drive.toml")
    said = str(refused.value)
    assert said.startswith(str(path))
    assert place in said
    assert "\n" not in said


def test_a_message_that_a_part_of_a_database_lacks_is_named(
    recorded: Recorded, tmp_path: Path
) -> None:
    """The file that it leaves to be included is another one."""
    signals = '[can.signals]\n"odometer.speed_mps" = { message = "WHEEL_SPEEDS", signal = "RL" }\n'
    drive = load_drive(drive_with(recorded("dbc") / "toyota_nodsu_pt.dbc", tmp_path, signals))
    with pytest.raises(InputError, match="names message WHEEL_SPEEDS, which no dbc"):
        recordings(drive, "drive.toml")


@pytest.mark.parametrize("content", [b"", b"\x00\x1b[2J\xff" * 500, b"VERSION \n\n" * 300])
def test_a_file_of_another_kind_is_a_short_line_that_a_terminal_can_show(
    tmp_path: Path, content: bytes
) -> None:
    """Nothing of its bytes moves a cursor."""
    path = tmp_path / "other.dbc"
    path.write_bytes(content)
    with pytest.raises(InputError, match="is no CAN database") as refused:
        load_database(path)
    assert str(refused.value).isprintable()
    assert len(refused.value.what) < 250
