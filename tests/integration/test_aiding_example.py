"""The example of docs/coupling.md, run as it stands."""

import re
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from builders import at
from wayline.bus import open_session
from wayline.codec import encode
from wayline.keys import message_key
from wayline.messages import AidedSatellite, Aiding
from wayline.router import open_router
from wayline.settings import BusSettings

PAGE = Path(__file__).parents[2] / "docs/coupling.md"
WAIT_S = 20.0
LINES_MAX = 20


def example() -> str:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    return str(code)


@pytest.fixture
def endpoint() -> Iterator[str]:
    """A router of the test's own."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"tcp/127.0.0.1:{port}"
    with open_router(BusSettings(connect=(address,))):
        yield address


def test_the_example_prints_where_to_search(endpoint: str) -> None:
    satellite = AidedSatellite(system="gps", prn=12, doppler_hz=-1234.0, doppler_std_hz=0.5)
    aid = Aiding(t_ns=at(0.0), satellites=(satellite,))
    heard = threading.Event()
    command = [sys.executable, "-c", example(), "bus-7", endpoint]
    with open_session(BusSettings(connect=(endpoint,))) as session:
        publisher = session.declare_publisher(message_key("bus-7", Aiding.topic, "fusion"))
        publisher.declare_matching_listener(lambda _: heard.set())
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as reader:
            if heard.wait(WAIT_S):
                publisher.put(encode(aid))
            else:
                reader.terminate()
            assert reader.stdout is not None
            line = reader.stdout.readline()
            reader.terminate()
    assert line == "gps 12: search from -1235.5 to -1232.5 Hz\n"


def test_the_example_is_short() -> None:
    assert len(example().splitlines()) <= LINES_MAX
