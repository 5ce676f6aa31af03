"""A live agency: asked on loopback, as it answers, refuses, redirects and falls silent."""

import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import msgspec
import pytest

from agency import AgencyServer, Answer, Asked, Bus, agency_server, payload_of
from wayline.errors import InputError
from wayline.inputs import PositionReport
from wayline.live_sources import LiveAvl
from wayline_gps_ingest.agency_key import key_of
from wayline_gps_ingest.realtime_feed import RealtimeFeed

WAIT_S = 10.0
KEY = "a-secret-of-the-agency"


@pytest.fixture
def server() -> Iterator[AgencyServer]:
    with agency_server() as started:
        yield started


class Heard:
    """What a feed has put."""

    def __init__(self) -> None:
        self.reports: list[tuple[str | None, PositionReport]] = []

    def __call__(self, message: msgspec.Struct, vehicle_id: str | None = None) -> None:
        assert isinstance(message, PositionReport)
        self.reports.append((vehicle_id, message))


@contextmanager
def asking(feed: RealtimeFeed) -> Iterator[Heard]:
    heard, stop = Heard(), threading.Event()
    with ThreadPoolExecutor(1) as threads:
        running = threads.submit(feed.run, heard, stop)
        try:
            yield heard
        finally:
            stop.set()
            running.result(WAIT_S)


def wait_for(is_so: Callable[[], bool]) -> None:
    until_s = time.monotonic() + WAIT_S
    while not is_so():
        assert time.monotonic() < until_s, "it never came"
        time.sleep(0.01)


def feed_on(server: AgencyServer, key: str | None = None, **options: str) -> RealtimeFeed:
    return RealtimeFeed("gps-ingest", LiveAvl(url=server.url, every_s=1.0, **options), key)


def now_s() -> int:
    return int(time.time())


def test_every_vehicle_of_an_agency_is_told_of_under_its_own_id(server: AgencyServer) -> None:
    payload = payload_of([Bus("Bus 1", told_s=now_s()), Bus("Bus 2", told_s=now_s())], now_s())
    server.answer = lambda _: Answer(payload)
    feed = feed_on(server)
    with asking(feed) as heard:
        wait_for(lambda: len(server.asked) > 1)
    assert [vehicle_id for vehicle_id, _ in heard.reports] == ["bus-1", "bus-2"], "each but once"
    assert all(report.received_ns is not None for _, report in heard.reports)
    assert feed.problem is None
    assert feed.detail == "127.0.0.1: 2 vehicles"


def test_a_feed_that_has_not_changed_need_not_be_sent_again(server: AgencyServer) -> None:
    payload = payload_of([Bus("1", told_s=now_s())], now_s())

    def answer(asked: Asked) -> Answer:
        if asked.headers.get("if-none-match") == '"one"':
            return Answer(status=304)
        return Answer(payload, headers={"ETag": '"one"'})

    server.answer = answer
    feed = feed_on(server)
    with asking(feed) as heard:
        wait_for(lambda: len(server.asked) > 1)
    assert len(heard.reports) == 1
    assert feed.problem is None


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (Answer(b"<html>Sign in</html>"), "answers with a web page"),
        (Answer(status=403), "answers 403"),
        (Answer(b"\x00" * (65 << 20)), "more than 64 MB"),
    ],
)
def test_an_answer_of_no_use_is_told_and_asked_for_less_often(
    server: AgencyServer, answer: Answer, words: str
) -> None:
    server.answer = lambda _: answer
    feed = feed_on(server)
    with asking(feed) as heard:
        wait_for(lambda: words in (feed.problem or ""))
        # the second look comes after two pauses, not one
        time.sleep(1.5)
        assert len(server.asked) == 1
    assert heard.reports == []


def test_a_feed_that_was_away_is_heard_again(server: AgencyServer) -> None:
    feed = feed_on(server)
    with asking(feed) as heard:
        wait_for(lambda: "503" in (feed.problem or ""))
        server.answer = lambda _: Answer(payload_of([Bus("1", told_s=now_s())], now_s()))
        wait_for(lambda: bool(heard.reports))
        wait_for(lambda: feed.problem is None)


def test_a_redirect_is_followed_on_its_host_and_nowhere_else(server: AgencyServer) -> None:
    payload = payload_of([Bus("1", told_s=now_s())], now_s())

    def moved(asked: Asked) -> Answer:
        is_old = asked.path.startswith("/vehicles.pb")
        return Answer(status=302, headers={"Location": "/new"}) if is_old else Answer(payload)

    server.answer = moved
    with asking(feed_on(server)) as heard:
        wait_for(lambda: bool(heard.reports))
    with agency_server() as elsewhere:
        elsewhere.answer = lambda _: Answer(payload)
        server.answer = lambda _: Answer(status=302, headers={"Location": elsewhere.url})
        feed = feed_on(server, KEY, api_key_header="x-api-key")
        with asking(feed):
            wait_for(lambda: "redirects to" in (feed.problem or ""))
        assert elsewhere.asked == [], "least of all with a key"


@pytest.mark.parametrize("way", [{"api_key_header": "X-Api-Key"}, {"api_key_parameter": "key"}])
def test_a_key_is_sent_as_asked_and_never_said(
    server: AgencyServer, way: dict[str, str], caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("DEBUG")
    feed = feed_on(server, KEY, **way)
    with asking(feed):
        wait_for(lambda: bool(server.asked))
        wait_for(lambda: "503" in (feed.problem or ""))
    (asked, *_) = server.asked
    sent = asked.headers.get("x-api-key", "") + asked.path
    assert KEY in sent
    assert KEY not in f"{feed.detail} {feed.problem} {caplog.text}"


def test_a_server_that_is_not_there_is_told(server: AgencyServer) -> None:
    del server
    feed = RealtimeFeed("gps-ingest", LiveAvl(url="http://127.0.0.1:9/x", every_s=1.0), None)
    with asking(feed):
        wait_for(lambda: "cannot be asked" in (feed.problem or ""))


def test_a_key_that_is_missing_stops_the_start() -> None:
    avl = LiveAvl(url="https://agency.example/x", api_key_env="KEY", api_key_header="x-api-key")
    assert key_of(avl, {"KEY": KEY}) == KEY
    with pytest.raises(InputError, match="KEY is not set"):
        key_of(avl, {})
    with pytest.raises(InputError, match="api_key_header or api_key_parameter"):
        key_of(msgspec.structs.replace(avl, api_key_header=None), {"KEY": KEY})
