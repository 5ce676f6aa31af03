"""The live system: real processes, a real router, what a program beside them hears and gets."""

import json
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest
import zenoh

from street import ROUTE, VEHICLE, Receiver
from wayline.bus import open_session
from wayline.keys import query_key
from wayline.messages import Arrivals, Health, Horizon, Pose, Progress
from wayline.services import SERVICES
from wayline_cli.listener import Heard, Listener
from wayline_cli.live_check import check_live
from wayline_cli.local_system import LocalSystem

WAIT_S = 15.0
STATES = ("pose", "progress", "arrivals", "horizon")


def get(url: str) -> str:
    """The body of an answer with status 200."""
    with urllib.request.urlopen(url, timeout=WAIT_S) as answer:
        body: bytes = answer.read()
    return body.decode()


def get_json(url: str) -> Any:
    return json.loads(get(url))


def reaches(t_ns: int) -> Callable[[Heard], bool]:
    return lambda heard: heard.message.t_ns >= t_ns


def drive(receiver: Receiver, listener: Listener, seconds: int) -> None:
    """Drive on; returns when everything that follows from the last fix was heard."""
    receiver.drive(seconds)
    for topic in STATES:
        listener.await_message(topic, reaches(receiver.t_ns), timeout_s=WAIT_S)


def test_a_real_minute_played_live_gives_the_poses_of_its_replay(
    recorded: Callable[[str], Path],
) -> None:
    report = check_live(recorded("comma-seg40-can"), speed=5.0)
    assert report.published["gps_fix"] > 500
    assert report.published["odometer"] > 2000
    assert report.published["gyro"] > 4000
    assert not any(report.lost.values())
    assert not any(report.fusion_lost.values())
    assert report.dropped == 0
    assert report.poses >= 600
    assert report.near_share >= 0.99


@pytest.mark.parametrize("service", SERVICES)
def test_every_service_answers_for_its_health_and_counts(
    running: LocalSystem, service: str
) -> None:
    health = get_json(f"{running.url(service)}/livez")
    assert (health["ok"], health["service"]) == (True, service)
    metrics = get(f"{running.url(service)}/metrics")
    assert "wayline_bad_input 0.0" in metrics.splitlines()


def test_fixes_become_poses_progress_arrivals_and_a_horizon(
    receiver: Receiver, listener: Listener
) -> None:
    drive(receiver, listener, 60)
    pose = listener.heard("pose")[-1].message
    assert isinstance(pose, Pose)
    assert pose.heading_deg is not None
    assert min(pose.heading_deg, 360.0 - pose.heading_deg) < 5.0
    progress = listener.heard("progress")[-1].message
    assert isinstance(progress, Progress)
    assert progress.route_id == ROUTE
    assert progress.on_route
    arrivals = listener.heard("arrivals")[-1].message
    assert isinstance(arrivals, Arrivals)
    assert [stop.stop_id for stop in arrivals.stops] == ["stop-2", "stop-3"]
    horizon = listener.heard("horizon")[-1].message
    # no earlier run is known of this street
    assert isinstance(horizon, Horizon)
    assert all(point.grade_pct is None for point in horizon.points)


def test_a_late_joiner_has_the_last_states_at_once_though_nothing_comes_in_any_more(
    running: LocalSystem, receiver: Receiver, listener: Listener
) -> None:
    # one after another: after a burst some states would only come by the clock
    for _ in range(5):
        drive(receiver, listener, 1)
    before = {topic: listener.heard(topic)[-1].message.t_ns for topic in STATES}
    with open_session(running.bus) as session:
        joined_s = time.monotonic()
        late = Listener(session, VEHICLE, STATES)
        first = {topic: late.await_message(topic, timeout_s=WAIT_S) for topic in STATES}
        late.close()
    # not what came next by the clock, but what was there when it joined
    after = {topic: listener.heard(topic)[-1].message.t_ns for topic in STATES}
    assert max(heard.received_s - joined_s for heard in first.values()) < 1.0
    for topic, heard in first.items():
        assert before[topic] <= heard.message.t_ns <= after[topic]
        assert heard.message.t_ns - before[topic] < 1_000_000_000


def test_a_bad_payload_under_a_good_key_is_counted_in_health_and_dropped(
    receiver: Receiver, listener: Listener
) -> None:
    receiver.put("gps_fix", b'{"t_ns":1,"valid":')
    heard = listener.await_message(
        "health",
        lambda h: (
            isinstance(h.message, Health)
            and h.message.service == "fusion"
            and h.message.bad_input > 0
        ),
        timeout_s=WAIT_S,
    )
    assert isinstance(heard.message, Health)
    assert heard.message.bad_input == 1
    drive(receiver, listener, 2)


def test_arrivals_are_the_same_over_http_and_zenoh(
    running: LocalSystem, session: zenoh.Session, receiver: Receiver, listener: Listener
) -> None:
    drive(receiver, listener, 2)

    def ask_bus(selector: str) -> Any:
        replies = session.get(selector, timeout=WAIT_S)
        (sample,) = [reply.ok for reply in replies]
        assert sample is not None
        return json.loads(sample.payload.to_bytes())

    def of_one_board(path: str, selector: str) -> tuple[Any, Any]:
        """Both answers, asked between two messages."""
        while True:
            before = get_json(running.url("eta") + path)
            found = ask_bus(selector)
            if fixed(before) == fixed(get_json(running.url("eta") + path)):
                return before, found

    key, path = query_key(VEHICLE, "arrivals"), f"/v1/vehicles/{VEHICLE}/arrivals"
    over_http, over_zenoh = of_one_board(path, key)
    assert len(over_http["arrivals"]) == 2
    assert fixed(over_zenoh) == fixed(over_http)
    over_http, over_zenoh = of_one_board(f"{path}?stop_id=stop-3", f"{key}?stop_id=stop-3")
    assert [at["stop_id"] for at in over_zenoh["arrivals"]] == ["stop-3"]
    assert fixed(over_zenoh) == fixed(over_http)


def fixed(answer: Any) -> Any:
    """An answer without what counts from the instant of asking."""
    return [
        {name: value for name, value in at.items() if name not in {"seconds", "age_s"}}
        for at in answer["arrivals"]
    ]


def test_a_wrong_question_is_refused_alike_over_http_and_zenoh(
    running: LocalSystem, session: zenoh.Session
) -> None:
    with pytest.raises(urllib.error.HTTPError) as refused:
        get(f"{running.url('eta')}/v1/vehicles/nobody/arrivals")
    problem = json.loads(refused.value.read())
    refused.value.close()
    (reply,) = session.get(query_key("nobody", "arrivals"), timeout=WAIT_S)
    assert reply.err is not None
    told = msgspec.json.decode(reply.err.payload.to_bytes())
    assert (refused.value.code, told["detail"]) == (404, problem["detail"])


def test_a_dashboard_open_to_all_without_a_token_does_not_start(running: LocalSystem) -> None:
    config = running.write_config("open.toml", vehicle_id=VEHICLE)
    config.write_text(config.read_text() + '[http]\nhost = "0.0.0.0"\nport = 0\n')
    running.start_command(
        "open-dashboard", (*running.command("dashboard"), "--config", str(config))
    )
    assert running.await_end("open-dashboard", WAIT_S) == 2
    said = running.said("open-dashboard").splitlines()
    assert "WAYLINE_HTTP_TOKEN" in said[-1]
    assert said[-1].startswith("wayline-dashboard: ")
    assert not any("Traceback" in line for line in said)
