"""Receivers' URLs: what is refused, with the mend."""

import pytest

from wayline.errors import InputError
from wayline.live_sources import LiveNmea
from wayline_gps_ingest.links import address_of


@pytest.mark.parametrize(
    "url",
    [
        "serial:///dev/ttyUSB0",
        "serial:///dev/serial/by-id/usb-u-blox_7-if00?baud=115200",
        "tcp://receiver.local:10110",
        "tcp://[::1]:10110",
        "udp://:10110",
        "udp://127.0.0.1:10110",
        "gpsd://localhost",
        "gpsd://localhost:2947/dev/ttyACM0",
    ],
)
def test_what_a_technician_would_write_is_taken(url: str) -> None:
    """Nothing is opened yet."""
    address_of(LiveNmea(url=url))


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("serial://", "names no device"),
        ("serial:///dev/ttyS0?baud=fast", "no rate"),
        ("serial:///dev/ttyS0?baud=0", "no rate"),
        ("serial:///dev/ttyS0?parity=odd", "unknown option parity"),
        ("tcp://receiver", "lacks a host or a port"),
        ("tcp://:10110", "lacks a host or a port"),
        ("tcp://receiver:port", "lacks a host or a port"),
        (f"tcp://{'a' * 64}:1", "lacks a host or a port"),
        ("udp://", "lacks a host or a port"),
        ("gpsd://:2947", "lacks a host or a port"),
    ],
)
def test_a_url_that_cannot_work_is_refused_at_the_start(url: str, words: str) -> None:
    """The service says so instead of trying for ever."""
    with pytest.raises(InputError, match=words):
        address_of(LiveNmea(url=url))
