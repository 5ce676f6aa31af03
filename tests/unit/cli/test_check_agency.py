"""The doctor asks an agency's feed once, and says what is wrong with it."""

import time
from collections.abc import Iterator

import pytest

from agency import AgencyServer, Answer, Bus, agency_server, payload_of
from wayline.live_sources import LiveAvl
from wayline_cli.check import Check, Mark
from wayline_cli.check_agency import check_agencies


@pytest.fixture
def server() -> Iterator[AgencyServer]:
    with agency_server() as started:
        yield started


def checked(server: AgencyServer, key_name: str | None = None) -> Check:
    avl = LiveAvl(url=server.url, api_key_env=key_name, api_key_header="x-api-key")
    (check,) = check_agencies([avl], {})
    return check


def test_a_feed_that_answers_is_well(server: AgencyServer) -> None:
    server.answer = lambda _: Answer(payload_of([Bus("1"), Bus("2")], int(time.time())))
    check = checked(server)
    assert "2 vehicles" in check.finding
    assert check.mark is Mark.FINE


@pytest.mark.parametrize(
    ("answer", "finding", "mend"),
    [
        (Answer(status=403), "answers 403", "key"),
        (Answer(b"<html>"), "a web page", "GTFS-Realtime"),
        (Answer(payload_of([Bus("1")], 1_700_000_000)), "s old", "stands still"),
    ],
)
def test_what_is_wrong_with_a_feed_is_said_with_the_mend(
    server: AgencyServer, answer: Answer, finding: str, mend: str
) -> None:
    server.answer = lambda _: answer
    check = checked(server)
    assert finding in check.finding
    assert check.mark is Mark.WRONG
    assert mend in check.mend


def test_a_key_that_is_not_set_is_said(server: AgencyServer) -> None:
    check = checked(server, "AGENCY_KEY")
    assert check.finding == "AGENCY_KEY is not set"
    assert server.asked == []
