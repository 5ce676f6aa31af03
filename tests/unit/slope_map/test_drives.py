"""What was left out is kept in the database, bounded, and told over HTTP, by command and health."""

from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import pytest
import sqlalchemy as sa
from typer.testing import CliRunner

from unit.slope_map.asking import client
from unit.slope_map.test_smoothing_worker import Here, worker_at
from unit.slope_map.test_store import HOUR_NS, PACKAGE, START_NS, run
from wayline.database import open_database
from wayline.messages import Pose
from wayline.view import Receipt
from wayline_cli.__main__ import app
from wayline_slope_map import left_out_rows
from wayline_slope_map.book import SlopeBook
from wayline_slope_map.drives import Kept, kept_of
from wayline_slope_map.left_out import COUNTED, WALKED, LeftOut
from wayline_slope_map.left_out_rows import every, newest
from wayline_slope_map.store import SlopeStore, SlopeTables
from wayline_slope_map.tally import Tally


def part(k: int, *, vehicle_id: str = "car", reason: str = WALKED) -> LeftOut:
    return LeftOut(
        vehicle_id=vehicle_id,
        sensor=None if k % 2 else "torque",
        reason=reason,
        start_ns=START_NS + k * HOUR_NS,
        end_ns=START_NS + k * HOUR_NS + HOUR_NS // 2,
        length_m=321.0 + k,
        start_lat_deg=56.0,
        start_lon_deg=10.0,
    )


@pytest.fixture
def engine(database_url: str) -> Iterator[sa.Engine]:
    opened = open_database(database_url, PACKAGE)
    yield opened
    opened.dispose()


def parts_of(engine: sa.Engine, vehicle_id: str = "car", limit: int = 100) -> list[LeftOut]:
    with engine.connect() as connection:
        return newest(connection, vehicle_id, limit)


def test_what_is_kept_comes_back_as_it_was_the_newest_first(engine: sa.Engine) -> None:
    store = SlopeStore(engine)
    for each in (part(0), part(2), part(1), part(0, vehicle_id="bus")):
        assert store.save(each) == []
    assert parts_of(engine) == [part(2), part(1), part(0)]
    assert parts_of(engine, limit=2) == [part(2), part(1)]
    with engine.connect() as connection:
        assert [each.vehicle_id for each in every(connection)] == ["bus", "car", "car", "car"]


def test_a_part_that_is_told_twice_is_kept_once(engine: sa.Engine) -> None:
    for _ in range(2):
        SlopeStore(engine).save(part(1))
    assert parts_of(engine) == [part(1)]


def test_of_each_vehicle_the_newest_parts_are_kept(
    engine: sa.Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(left_out_rows, "KEPT", 3)
    store = SlopeStore(engine)
    store.save(part(0, vehicle_id="bus"))
    for k in (4, 0, 3, 1, 2):
        store.save(part(k))
    assert parts_of(engine) == [part(4), part(3), part(2)]
    assert parts_of(engine, "bus") == [part(0, vehicle_id="bus")]


def test_a_store_counts_by_reason_and_health_says_so(engine: sa.Engine) -> None:
    tally = Tally()
    tables = SlopeTables(engine, tally)
    assert tally.notice() is None
    for record in (part(0), part(1), part(2, reason="frozen"), run(0), run(0)):
        tables.save("car", record)
    assert tally.counts == {WALKED: 2, "frozen": 1, COUNTED: 1}
    assert tally.notice() == f"left out of the map: 2 x {WALKED}, 1 x frozen, 1 x {COUNTED}"


def test_what_was_left_out_while_driving_is_kept_live(tmp_path: Path) -> None:
    worker = worker_at(tmp_path, lambda: Here(lambda _: []))
    worker.start(lambda: None)
    assert worker.save(part(0)) == ()
    worker.close()
    assert parts_of(open_database(f"sqlite:///{tmp_path}/live.db", PACKAGE)) == [part(0)]


@pytest.fixture
def kept(engine: sa.Engine) -> Kept:
    for record in (run(0), run(1), part(0), part(1)):
        SlopeStore(engine).save(record)
    with engine.connect() as connection:
        return kept_of(connection, "car", 100)


def test_http_tells_what_drives_have_taught_and_what_not(kept: Kept) -> None:
    answer = client(SlopeBook(), kept=kept).get("/v1/vehicles/car/runs").json()
    assert answer["vehicle_id"] == "car"
    assert [each["start"] for each in answer["runs"]] == [
        "2023-11-14T23:13:20.000Z",
        "2023-11-14T22:13:20.000Z",
    ]
    assert {key: answer["runs"][0][key] for key in ("road_id", "direction", "state")} == {
        "road_id": "road-a",
        "direction": "forward",
        "state": "merged",
    }
    assert answer["left_out"] == [
        {
            "sensor": None,
            "reason": WALKED,
            "start": "2023-11-14T23:13:20.000Z",
            "end": "2023-11-14T23:43:20.000Z",
            "length_m": 322.0,
            "start_lat_deg": 56.0,
            "start_lon_deg": 10.0,
            "end_lat_deg": None,
            "end_lon_deg": None,
        },
        {
            **answer["left_out"][1],
            "sensor": "torque",
            "length_m": 321.0,
        },
    ]


@pytest.mark.parametrize(
    ("vehicle_id", "limit", "kept_there", "status"),
    [
        ("car", "100", None, 503),
        ("car", "100", Kept([], []), 404),
        ("Not%20one", "100", Kept([], []), 404),
        ("car", "0", Kept([], []), 422),
        ("car", "1001", Kept([], []), 422),
        ("truck", "100", Kept([], []), 200),
    ],
)
def test_what_cannot_be_told_is_a_problem(
    vehicle_id: str, limit: str, kept_there: Kept | None, status: int
) -> None:
    """The truck is heard now; nothing else is known of it."""
    book = SlopeBook()
    book.put("truck", Pose(t_ns=START_NS, mode="fused", distance_m=0.0), "fusion", Receipt(0))
    answer = client(book, kept=kept_there).get(
        f"/v1/vehicles/{vehicle_id}/runs", params={"limit": limit}
    )
    assert answer.status_code == status, answer.text


def test_the_command_lists_what_was_left_out(new_url: Callable[[], str]) -> None:
    url = new_url()
    engine = open_database(url, PACKAGE)
    for k in range(2):
        SlopeStore(engine).save(msgspec.structs.replace(part(k), end_lat_deg=56.1))
    engine.dispose()
    result = CliRunner().invoke(app, ["slope", "list", "--left-out", "--database", url])
    assert result.exit_code == 0, result.output
    head, first, second = result.stdout.splitlines()
    assert head.startswith("vehicle_id,start,end,length_m,sensor,reason,start_lat_deg")
    assert first == (
        "car,2023-11-14T22:13:20.000Z,2023-11-14T22:43:20.000Z,321,torque,"
        f'"{WALKED}",56.000000,10.000000,56.100000,'
    )
    assert f',322,,"{WALKED}",' in second
