"""What `health` and /metrics say of a service."""

from prometheus_client import generate_latest

from builders import about, at
from wayline.messages import Health
from wayline.telemetry import Telemetry, joined


def health(telemetry: Telemetry, seconds: float) -> Health:
    return telemetry.health(at(0), seconds, backlog=0, dropped=0, bad_input=0, detail=None)


def test_rates_are_those_since_the_last_health() -> None:
    telemetry = Telemetry("fusion", at(0))
    for _ in range(10):
        telemetry.heard("gyro", 0)
    telemetry.took(0)
    telemetry.published("pose")
    first = health(telemetry, 2)
    assert (first.in_rate_hz, first.out_rate_hz) == (about(5.5), about(0.5))
    second = health(telemetry, 3)
    assert (second.in_rate_hz, second.out_rate_hz) == (0.0, 0.0)
    assert second.started_ns == at(0)


def test_faults_are_told_as_a_rate_and_leave_no_scar() -> None:
    telemetry = Telemetry("fusion", at(0))
    told = []
    for second in range(1, 30):
        if second == 5:
            telemetry.lost(20)
            telemetry.bad()
        told.append(health(telemetry, second))
    rates = [(each.dropped_rate_hz, each.bad_input_rate_hz) for each in told]
    assert rates[3] == (0.0, 0.0)
    assert rates[4] == (about(4.0), about(0.2))
    assert rates[12] == (about(2.0), about(0.1))
    assert rates[15:] == [(0.0, 0.0)] * 14
    assert told[-1].dropped == 20


def test_lag_is_how_long_messages_wait_before_they_are_taken() -> None:
    telemetry = Telemetry("fusion", at(0))
    assert health(telemetry, 1).lag_ms_p50 is None
    for hundredth in range(101):
        telemetry.heard("gyro", hundredth * 10_000_000)
    after = health(telemetry, 2)
    assert (after.lag_ms_p50, after.lag_ms_p99) == (about(500.0), about(990.0))


def test_what_the_bus_lost_and_the_inbox_dropped_add_up_and_so_does_bad_input() -> None:
    telemetry = Telemetry("fusion", at(0))
    telemetry.lost(3)
    telemetry.bad()
    counted = telemetry.health(at(1), 1.0, backlog=4, dropped=2, bad_input=6, detail="playing")
    assert (counted.dropped, counted.bad_input, counted.backlog) == (5, 7, 4)
    assert counted.detail == "playing"


def test_prometheus_reads_the_same_counts() -> None:
    telemetry = Telemetry("fusion", at(0))
    telemetry.heard("gyro", 3_000_000)
    telemetry.published("pose")
    telemetry.lost(3)
    health(telemetry, 1)
    lines = generate_latest(telemetry.registry).decode().splitlines()
    assert 'wayline_messages_in_total{topic="gyro"} 1.0' in lines
    assert 'wayline_messages_out_total{topic="pose"} 1.0' in lines
    assert "wayline_dropped 3.0" in lines
    assert 'wayline_lag_seconds_bucket{le="0.002"} 0.0' in lines
    assert 'wayline_lag_seconds_bucket{le="0.005"} 1.0' in lines


def test_details_that_are_too_long_together_are_cut_where_they_are_longest() -> None:
    assert joined([]) == ""
    assert joined(["a", "b"]) == "a; b"
    whole = ["x" * 127, "y" * 127]
    assert joined(whole) == "; ".join(whole)
    short = "tcp://127.0.0.1:4001: well"
    by_id = "serial:///dev/serial/by-id/usb-u-blox_GNSS_receiver-if0"
    long = [f"{by_id}{port}: silent for {'very ' * 40}long" for port in range(3)]
    first, *others = joined([short, *long]).split("; ")
    assert first == short
    for port, each in enumerate(others):
        assert each.startswith(f"…{by_id[-22:]}{port}: silent for")
    assert {len(each) for each in others} == {(256 - 3 * 2 - len(short)) // 3}
    assert all(each.endswith("…") for each in others)
    assert len(joined(["z" * 9] * 200)) == 256
