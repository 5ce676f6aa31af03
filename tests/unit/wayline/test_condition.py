"""How a service says that it does: alive while its loop turns, ready while it lacks nothing."""

import dataclasses
import time

import pytest
import zenoh

from echoing import ONE, echo
from wayline.condition import STUCK_S, Condition
from wayline.inbox import Inbox, Sample
from wayline.telemetry import Telemetry

NOW_NS = 1_800_000_000_000_000_000


def condition(session: zenoh.Session, inbox: Inbox) -> Condition:
    return Condition(echo(), ONE, session, inbox, Telemetry("echo", NOW_NS))


def test_a_loop_that_stands_still_is_not_alive(
    session: zenoh.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = condition(session, Inbox())
    one.turn(time.monotonic())
    assert one.healthz().alive
    late_s = time.monotonic() + STUCK_S + 1.0
    monkeypatch.setattr(time, "monotonic", lambda: late_s)
    answer = one.healthz()
    assert not answer.alive
    assert "has not turned for 11 s" in (answer.detail or "")


def test_a_service_that_has_not_looked_yet_is_starting(session: zenoh.Session) -> None:
    answer = condition(session, Inbox()).healthz()
    assert answer.alive
    assert not answer.ok
    assert [each.what for each in answer.missing] == ["starting"]


def test_it_lacks_what_it_works_with_until_that_comes(session: zenoh.Session) -> None:
    one = condition(session, Inbox())
    assert [each.subject for each in one.look(1.0).missing] == ["router", "input"]
    one.hear(2.0)
    assert [each.subject for each in one.look(2.5).missing] == ["router"]
    assert [each.subject for each in one.look(60.0).missing] == ["router", "input"]


def test_the_log_names_whose_messages_were_dropped_once(
    session: zenoh.Session, caplog: pytest.LogCaptureFixture
) -> None:
    inbox = Inbox(capacity=2)
    one = condition(session, inbox)
    for _ in range(5):
        inbox.put(Sample("wayline/v1/mallory/pose/fusion", b"", NOW_NS))
    one.look(1.0)
    one.look(2.0)
    assert [record.getMessage() for record in caplog.records] == [
        "3 messages dropped so far, just now 3 of mallory"
    ]


def test_health_says_what_a_service_has_to_say(session: zenoh.Session) -> None:
    """Such as a timetable that has ended; while there is nothing, no detail."""
    told: list[str | None] = [None, "no service runs any longer"]
    service = dataclasses.replace(echo(), notice=lambda: told.pop(0))
    one = Condition(service, ONE, session, Inbox(), Telemetry("echo", NOW_NS))
    assert one.look(1.0).detail is None
    assert one.look(2.0).detail == "no service runs any longer"
