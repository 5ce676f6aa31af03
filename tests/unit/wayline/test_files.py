"""Configuration and drive files: what does not fit is one line with the place and the mend."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from wayline.drive import Vehicle
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.topics_doc import render

ROOT = Path(__file__).parents[3]
DRIVE = '[drive]\nvehicle_id = "car"\n[[nmea]]\npath = "a.nmea"\n'


def written(folder: Path, text: str) -> Path:
    (folder / "drive.toml").write_text(text, encoding="utf-8")
    (folder / "a.nmea").write_text("$GPRMC\n", encoding="utf-8")
    return folder


def test_a_drive_loads_with_absolute_paths_and_defaults(tmp_path: Path) -> None:
    drive = load_drive(written(tmp_path, DRIVE))
    assert drive.nmea[0].path == str(tmp_path / "a.nmea")
    assert drive.vehicle == Vehicle()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (DRIVE + "colour = 1\n", r"unknown key nmea\[0\]\.colour; remove it"),
        (DRIVE + "[vehicle]\nmass = 1\n", r"unknown key vehicle\.mass; remove it"),
        (DRIVE + "[tuning]\ngps_speed_std = 1\n", r"unknown key tuning\.gps_speed_std; remove it"),
        (DRIVE + "[vehicle]\nmass_kg = -1.0\n", r"vehicle\.mass_kg: .*> 0"),
        (DRIVE + '[vehicle]\nmass_kg = "heavy"\n', r"vehicle\.mass_kg: Expected `float`"),
        (
            DRIVE + '[tuning]\narchitecture = "tight"\n',
            r"tuning\.architecture: .*'tight'; give one of gps_only, .*loose, measurement,",
        ),
        (
            DRIVE + '[tuning]\nvertical_sensors = ["gps", "sonar"]\n',
            r"vertical_sensors\[1\]: .*'sonar'; give one of barometer, gps",
        ),
        ('[drive]\nvehicle_id = "Car 1"\n', r"drive\.vehicle_id: .*regex"),
        ("[drive]\n", r"missing key drive\.vehicle_id; add it"),
        ('[drive]\nvehicle_id = "car"\n', r"no input; add a \[\[nmea\]\]"),
        (DRIVE.replace("a.nmea", "b.nmea"), r"file b\.nmea is missing; correct the path"),
        (DRIVE + '[route]\npath = "r.geojson"\n', r"file r\.geojson is missing"),
        ("drive\n", r"is not TOML \(.*line 1.*\); correct that line"),
    ],
)
def test_a_drive_that_does_not_fit_is_one_line(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(InputError) as caught:
        load_drive(written(tmp_path, text))
    assert re.search(says, str(caught.value)), caught.value
    assert str(tmp_path / "drive.toml") in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_folder_without_a_drive_says_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no drive\.toml there; name a drive's folder"):
        load_drive(tmp_path)


def test_the_page_of_topics_is_fresh() -> None:
    """`python -m wayline.topics_doc > docs/topics.md` mends it."""
    assert (ROOT / "docs" / "topics.md").read_text(encoding="utf-8") == render()


def test_the_page_of_topics_can_be_written_by_its_command() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "wayline.topics_doc"], capture_output=True, check=True, text=True
    )
    assert done.stdout == render()
