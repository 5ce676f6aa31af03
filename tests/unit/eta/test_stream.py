"""Answers that are made once a tick, and arrivals and progress as server-sent events."""

import asyncio
import http.client
import json
from collections.abc import AsyncIterator, Callable
from typing import Any

import msgspec
import pytest
from fastapi.testclient import TestClient

from unit.eta.route_drives import SQUARE, Told, follow, poses
from unit.eta.test_app import ROUTE, Board, Clock, last_pose, later
from wayline.http_server import HttpServer
from wayline.http_settings import HttpSettings
from wayline.tuning import Tuning
from wayline_eta.answers import ArrivalList
from wayline_eta.app import create_eta_app
from wayline_eta.core import EtaCore
from wayline_eta.rendered import ANSWERS_MAX, Rendered
from wayline_eta.stream import HEARTBEAT, Reader, StreamParameters, stream


class Answer(msgspec.Struct):
    number: int


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture(scope="module")
def told() -> Told:
    return follow(EtaCore([ROUTE], Tuning()), poses(SQUARE, [10.0] * 21))[-1]


@pytest.fixture
def board(clock: Clock, told: Told) -> Board:
    board = Board(clock)
    board.hear("bus-1", last_pose(), "fusion")
    board.hear("bus-1", told.progress, "eta")
    board.hear("bus-1", told.arrivals, "eta")
    return board


def numbered() -> Callable[[], Answer]:
    count = iter(range(1_000_000))
    return lambda: Answer(next(count))


def test_an_answer_stands_for_a_tick_unless_what_it_rests_on_changes(clock: Clock) -> None:
    rendered, make = Rendered(clock), numbered()
    first = rendered.of_one("a", 1, make)
    clock.wait(0.9)
    assert rendered.of_one("a", 1, make) is first
    assert rendered.of_one("a", 2, make) != first
    clock.wait(1.0)
    assert rendered.of_one("a", 2, make) == b'{"number":2}'
    assert rendered.of_one("b", 2, make) == b'{"number":3}'


def test_what_is_told_of_many_is_made_ten_times_a_second_at_most(clock: Clock) -> None:
    rendered, make = Rendered(clock), numbered()
    answers = set()
    for _ in range(100):
        answers.add(rendered.of_many("a", make))
        clock.wait(0.01)
    assert len(answers) == 10


def test_questions_without_end_take_no_memory_without_end(clock: Clock) -> None:
    rendered, make = Rendered(clock), numbered()
    first = rendered.of_one(0, 1, make)
    for question in range(1, ANSWERS_MAX + 1):
        rendered.of_one(question, 1, make)
    assert rendered.of_one(0, 1, make) != first


def test_over_http_a_vehicles_answer_is_made_once_a_tick(
    board: Board, clock: Clock, told: Told, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    arrivals = board.arrivals

    def counted(vehicle_id: str, stop_id: str | None = None) -> ArrivalList:
        asked.append(vehicle_id)
        return arrivals(vehicle_id, stop_id)

    monkeypatch.setattr(board, "arrivals", counted)
    http = TestClient(create_eta_app(board, [ROUTE], HttpSettings()), base_url="http://localhost")
    path = "/v1/vehicles/bus-1/arrivals"
    bodies = {http.get(path).content for _ in range(5)}
    assert (len(bodies), len(asked)) == (1, 1)
    board.hear("bus-1", later(told.arrivals, 1.0, stale=False), "eta")
    assert http.get(path).content not in bodies, "what is new is told at once"
    board.forget("bus-1")
    assert http.get(path).status_code == 404


def reader(board: Board, clock: Clock, **asked: Any) -> Reader:
    return Reader(board, Rendered(clock), StreamParameters(**asked))


def events(news: bytes) -> list[tuple[str, dict[str, Any]]]:
    found = []
    for block in news.decode().split("\n\n")[:-1]:
        name, data = (line.partition(": ")[2] for line in block.split("\n"))
        found.append((name, json.loads(data)))
    return found


def news(of: Reader) -> list[tuple[str, dict[str, Any]]]:
    return events(b"".join(of.news()))


def test_a_reader_is_told_all_that_is_known_and_then_what_is_new(
    board: Board, clock: Clock, told: Told
) -> None:
    one = reader(board, clock)
    (kind, progress), (other, arrivals) = news(one)
    assert (kind, other) == ("progress", "arrivals")
    assert progress["progress"]["route_id"] == ROUTE.route_id
    assert [at["stop_id"] for at in arrivals["arrivals"]] == ["s0", "s1", "s2"]
    assert news(one) == []
    board.hear("bus-1", later(told.arrivals, 1.0, stale=False), "eta")
    ((kind, _),) = news(one)
    assert kind == "arrivals"


def test_it_asks_for_a_vehicle_a_route_a_stop_or_what_is_soon(
    board: Board, clock: Clock, told: Told
) -> None:
    board.hear("bus-2", told.arrivals, "eta")
    assert {data["vehicle_id"] for _, data in news(reader(board, clock))} == {"bus-1", "bus-2"}
    of_vehicle = news(reader(board, clock, vehicle_id="bus-2"))
    assert [data["vehicle_id"] for _, data in of_vehicle] == ["bus-2"]
    assert news(reader(board, clock, route_id="nobody")) == []
    at_stop = news(reader(board, clock, stop_id="s1", vehicle_id="bus-2"))
    assert [at["stop_id"] for at in at_stop[0][1]["arrivals"]] == ["s1"]
    soon = news(reader(board, clock, minutes=0.5, vehicle_id="bus-2"))
    assert [at["stop_id"] for at in soon[0][1]["arrivals"]] == ["s0"]
    few = news(reader(board, clock, limit=2, vehicle_id="bus-2"))
    assert [at["stop_id"] for at in few[0][1]["arrivals"]] == ["s0", "s1"]


def test_that_nothing_comes_any_longer_is_told_once(board: Board, clock: Clock, told: Told) -> None:
    one = reader(board, clock, stop_id="s0")
    news(one)
    gone = msgspec.structs.replace(told.arrivals, stops=told.arrivals.stops[1:])
    clock.wait(0.1)
    board.hear("bus-1", gone, "eta")
    assert [data["arrivals"] for _, data in news(one)] == [[]]
    clock.wait(0.1)
    board.hear("bus-1", gone, "eta")
    assert news(one) == []


def test_a_silent_stream_says_that_it_is_there(board: Board, clock: Clock) -> None:
    async def first(chunks: AsyncIterator[bytes], count: int) -> list[bytes]:
        return [await anext(chunks) for _ in range(count)]

    chunks = stream(reader(board, clock), period_s=0.001, heartbeat_s=0.01)
    all_that_is_known, nothing = asyncio.run(first(chunks, 2))
    assert len(events(all_that_is_known)) == 2
    assert nothing == HEARTBEAT


def test_over_http_it_is_an_event_stream_that_ends_with_the_service(
    board: Board, caplog: pytest.LogCaptureFixture
) -> None:
    app = create_eta_app(board, [ROUTE], HttpSettings(port=0))
    with HttpServer(app, HttpSettings(port=0)) as server:
        refused = http.client.HTTPConnection("127.0.0.1", server.port, timeout=10.0)
        refused.request("GET", "/v1/stream?minutes=-1")
        assert refused.getresponse().status == 422
        refused.close()
        connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=10.0)
        connection.request("GET", "/v1/stream?vehicle_id=bus-1")
        answer = connection.getresponse()
        assert answer.headers["content-type"].startswith("text/event-stream")
        assert answer.readline() == b"event: progress\n"
    assert answer.read().endswith(b"\n\n"), "whole, though the service has ended"
    connection.close()
    assert not [record for record in caplog.records if record.levelname == "ERROR"]
