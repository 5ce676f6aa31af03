"""A process that sends back what it hears, by nothing but Zenoh: what a hop over the bus costs.

`python -m wayline_bench.echo ENDPOINT`
"""

import queue
import sys

from wayline.bus import open_session
from wayline.ending import ending_on_signals
from wayline.settings import BusSettings

ASK, ANSWER = "bench/ask", "bench/answer"
READY = "echoing"
POLL_S = 0.2


def numbered(number: int, size_bytes: int) -> bytes:
    """A message of a size that says its number."""
    return f"{number:<{size_bytes}d}".encode()


def main() -> None:
    """Echo until SIGTERM, out of a queue as every service does."""
    heard: queue.Queue[bytes] = queue.Queue()
    bus = BusSettings(connect=(sys.argv[1],))
    with ending_on_signals() as ending, open_session(bus) as session:
        answer = session.declare_publisher(ANSWER)
        subscriber = session.declare_subscriber(
            ASK, lambda sample: heard.put(sample.payload.to_bytes())
        )
        print(READY, flush=True)
        while not ending.requested:
            try:
                answer.put(heard.get(timeout=POLL_S))
            except queue.Empty:
                continue
        subscriber.undeclare()  # type: ignore[no-untyped-call]


if __name__ == "__main__":
    main()
