"""A bus's disruptions from its reports to what is kept of them, through `wayline replay`."""

from collections.abc import Iterator
from pathlib import Path
from zoneinfo import ZoneInfo

import numpy as np
import pytest
import sqlalchemy as sa

from unit.timetable.faulty_feeds import LAT_DEG, LON_DEG, good_feed, write_folder
from wayline.database import open_database
from wayline.messages import StopEvent
from wayline_eta.store import EtaTables
from wayline_eta.tables import KNOWN, TAKEN
from wayline_evaluation.replays import read_topic
from wayline_replay.replay import replay

NORTH_M = 111_194.9
STOP_M = 1_000.7
BERLIN = ZoneInfo("Europe/Berlin")
USUAL_M = [(0.0, 0.0), (60.0, 0.0), (540.0, 4.0 * STOP_M), (600.0, 4.0 * STOP_M)]
"""Seconds since a minute before eight, and how far from S0."""


@pytest.fixture
def database_url(tmp_path: Path) -> str:
    return f"sqlite:///{tmp_path / 'wayline.db'}"


@pytest.fixture
def engine(database_url: str) -> Iterator[sa.Engine]:
    opened = open_database(database_url, "wayline_eta")
    yield opened
    opened.dispose()


def drive(folder: Path, day: int, ways: list[tuple[float, float]], east: str = "") -> Path:
    """Reports every 20 s of a bus that runs trip T; `east` is beside which stop it goes round."""
    folder.mkdir()
    seconds_s, norths_m = np.array(ways).T
    rows = ["time,lat,lon,run"]
    for t_s in np.arange(0.0, seconds_s[-1] + 1.0, 20.0).tolist():
        north_m = float(np.interp(t_s, seconds_s, norths_m))
        is_round = east and abs(north_m - int(east) * STOP_M) < 400.0
        lat_deg, lon_deg = LAT_DEG + north_m / NORTH_M, LON_DEG + (0.005 if is_round else 0.0)
        at_s = 7 * 3600 + 59 * 60 + round(t_s)
        clock = f"{at_s // 3600:02d}:{at_s // 60 % 60:02d}:{at_s % 60:02d}"
        rows.append(f"2026-06-{day:02d} {clock},{lat_deg:.6f},{lon_deg:.6f},T")
    (folder / "avl.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    columns = 'time = "time", lat_deg = "lat", lon_deg = "lon", assignment = "run"'
    (folder / "drive.toml").write_text(
        f'[drive]\nvehicle_id = "bus"\n[[avl]]\npath = "avl.csv"\ncolumns = {{ {columns} }}\n'
        'timezone = "Europe/Berlin"\n',
        encoding="utf-8",
    )
    return folder


def of_the_leg(engine: sa.Engine) -> list[tuple[object, ...]]:
    """What is known of the leg from S1 to S2."""
    query = sa.select(KNOWN).where(KNOWN.c.key.like("leg\tfeed 0|S1>S2%")).order_by(KNOWN.c.key)
    with engine.connect() as connection:
        return [tuple(row) for row in connection.execute(query)]


def told(out: Path) -> list[tuple[str, str, str | None]]:
    return [(each.kind, each.stop_id, each.disruption) for each in read_topic(out, StopEvent)]


def test_a_breakdown_is_marked_and_teaches_nothing(
    tmp_path: Path, database_url: str, engine: sa.Engine
) -> None:
    """It stands for a quarter of an hour between S1 and S2; the same is learned anew."""
    feed = write_folder(good_feed(), tmp_path / "feed")
    usual = drive(tmp_path / "usual", 3, USUAL_M)
    replay(usual, tmp_path / "1", feed_paths=[feed], database_url=database_url)
    before = of_the_leg(engine)
    there_m = 1.5 * STOP_M
    stands = [*USUAL_M[:2], (240.0, there_m), (1_140.0, there_m)]
    later = [(t_s + 900.0, north_m) for t_s, north_m in USUAL_M[2:]]
    broken = drive(tmp_path / "broken", 4, [*stands, *later])
    replay(broken, tmp_path / "2", feed_paths=[feed], database_url=database_url)
    assert {each[2] for each in told(tmp_path / "1")} == {None}
    marked = [each for each in told(tmp_path / "2") if each[2] is not None]
    assert [each[1:] for each in marked] == [("S2", "breakdown")]
    with engine.connect() as connection:
        rows = connection.execute(sa.select(TAKEN.c.leg, TAKEN.c.disruption)).all()
    assert [row.leg for row in rows if row.disruption == "breakdown"] == ["feed 0|S1>S2"]
    assert of_the_leg(engine) == before
    with engine.begin() as connection:
        connection.execute(sa.delete(KNOWN))
    EtaTables(engine, BERLIN).look()
    assert of_the_leg(engine) == before


def test_stops_left_out_by_a_detour_are_marked(tmp_path: Path) -> None:
    """It goes round S2, 370 m beside its line."""
    feed = write_folder(good_feed(), tmp_path / "feed")
    replay(drive(tmp_path / "round", 3, USUAL_M, east="2"), tmp_path / "out", feed_paths=[feed])
    assert ("skipped", "S2", "detour") in told(tmp_path / "out")
    assert {each[1] for each in told(tmp_path / "out") if each[2] is not None} == {"S2"}
