"""Recorded vehicle positions of an agency, as a drive of one of its vehicles."""

import gzip
from collections.abc import Iterator
from pathlib import Path

import pytest
from google.protobuf import json_format

from agency import NOON_S, Bus, feed_of, payload_of
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.messages import GpsFix
from wayline.received import Sources
from wayline_gps_ingest.recorded import recordings


def drive(folder: Path, avl: str, vehicle_id: str = "bus-2") -> Path:
    folder.joinpath("drive.toml").write_text(
        f'[drive]\nvehicle_id = "{vehicle_id}"\n[[avl]]\n{avl}\n'
    )
    return folder


def told(folder: Path) -> tuple[list[GpsFix], Sources]:
    sources = Sources(recordings(load_drive(folder), str(folder)))
    fixes = [received.message for received in sources]
    sources.check()
    assert all(isinstance(fix, GpsFix) for fix in fixes)
    return [fix for fix in fixes if isinstance(fix, GpsFix)], sources


def rounds(count: int) -> Iterator[tuple[int, list[Bus]]]:
    """An agency of three, every 30 s."""
    for each in range(count):
        told_s = NOON_S + 30 * each
        buses = [
            Bus(f"Bus {n}", 38.9 + 0.001 * each, -77.0 + n, told_s, f"trip-{n}") for n in (1, 2, 3)
        ]
        yield told_s, buses


def test_a_folder_of_answers_is_a_drive_of_its_vehicle(tmp_path: Path) -> None:
    """Numbers in the files' names count by value; one of them is packed, one is a web page."""
    answers = tmp_path / "answers"
    answers.mkdir()
    for number, (told_s, buses) in enumerate(rounds(12)):
        payload = payload_of(buses, told_s)
        answers.joinpath(f"vp-{number}.pb").write_bytes(
            gzip.compress(payload) if number == 3 else payload
        )
    answers.joinpath("vp-99.pb").write_bytes(b"<html>later</html>")
    fixes, sources = told(drive(tmp_path, 'path = "answers"'))
    assert [fix.t_ns for fix in fixes] == [(NOON_S + 30 * n) * 10**9 for n in range(12)]
    assert {fix.lon_deg for fix in fixes} == {-75.0}
    assert {fix.assignment for fix in fixes} == {"trip-2"}
    assert sources.bad_input == {"gps-ingest": 1}
    assert sources.left_out == {"gps-ingest": {"of other vehicles": 24}}


def test_answers_in_json_may_stand_one_a_line(tmp_path: Path) -> None:
    lines = [
        json_format.MessageToJson(feed_of(buses, told_s), indent=None)
        for told_s, buses in rounds(3)
    ]
    tmp_path.joinpath("vp.jsonl").write_text("\n".join(lines))
    fixes, _ = told(drive(tmp_path, 'path = "vp.jsonl"\nwhere = { trip_id = "trip-3" }'))
    assert [fix.lon_deg for fix in fixes] == [-74.0] * 3


def test_the_only_vehicle_of_a_recording_may_have_any_name(tmp_path: Path) -> None:
    tmp_path.joinpath("vp.pb").write_bytes(payload_of([Bus("G-7311")]))
    fixes, _ = told(drive(tmp_path, 'path = "vp.pb"'))
    assert len(fixes) == 1


@pytest.mark.parametrize(
    ("content", "avl", "words"),
    [
        (payload_of([Bus("1"), Bus("3")]), "", r"none of its 2 vehicles is bus-2 \(there are 1, 3"),
        (payload_of([Bus("1")]), 'where = { label = "x" }', "is label x"),
        (b"<html>", "", "holds no GTFS-Realtime, but a web page"),
        (b"t,lat,lon\n1,2,3\n", "", "columns for a CSV"),
        (payload_of([]), "", "tells of no vehicle"),
    ],
)
def test_a_recording_of_no_use_is_one_clear_error(
    tmp_path: Path, content: bytes, avl: str, words: str
) -> None:
    tmp_path.joinpath("vp.pb").write_bytes(content)
    with pytest.raises(InputError, match=words):
        told(drive(tmp_path, f'path = "vp.pb"\n{avl}'))


def test_an_empty_folder_is_one_clear_error(tmp_path: Path) -> None:
    tmp_path.joinpath("answers").mkdir()
    with pytest.raises(InputError, match="empty folder"):
        told(drive(tmp_path, 'path = "answers"'))
