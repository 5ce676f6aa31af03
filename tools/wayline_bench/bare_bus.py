"""A process that reads a udp_multicast bus by python-can and does nothing with it.

`python -m wayline_bench.bare_bus GROUP PORT`
"""

import sys

import can

from wayline.ending import ending_on_signals

READY = "reading"
POLL_S = 0.2


def open_bus(group: str, port: int) -> can.BusABC:
    """The bus on this machine alone."""
    return can.Bus(interface="udp_multicast", channel=group, port=port, hop_limit=0)


def main() -> None:
    """Read until SIGTERM."""
    with ending_on_signals() as ending, open_bus(sys.argv[1], int(sys.argv[2])) as bus:
        print(READY, flush=True)
        while not ending.requested:
            bus.recv(POLL_S)


if __name__ == "__main__":
    main()
