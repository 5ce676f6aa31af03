"""A Zenoh router in a process of its own, so that a vehicle needs nothing but Python.

It asks nobody for a password, therefore it only listens on loopback; `python -m wayline.router`.
"""

import argparse
import json
import re
import sys
from pathlib import Path

import msgspec
import zenoh

from wayline.bus import client_config
from wayline.ending import ending_on_signals
from wayline.errors import InputError
from wayline.http_settings import is_loopback
from wayline.settings import BusSettings, load_settings


def router_config(settings: BusSettings) -> zenoh.Config:
    """Zenoh's configuration of a router that listens where the services connect.

    Raises InputError for an endpoint that others than this machine could reach.
    """
    if not settings.connect:
        mend = 'name one, e.g. "tcp/127.0.0.1:7447"'
        raise InputError("bus.connect", "is empty, the router has no endpoint", mend)
    endpoint = settings.connect[0]
    if not is_local(endpoint):
        mend = "use tcp/127.0.0.1:7447, or router = false and a zenohd with access control"
        raise InputError(f"bus.connect {endpoint}", "is not on this machine alone", mend)
    config = client_config(msgspec.structs.replace(settings, user=None, password=None))
    entries: dict[str, object] = {
        "mode": "router",
        "connect/endpoints": [],
        "listen/endpoints": [endpoint],
        # it looks for no other router
        "scouting/delay": 0,
    }
    for key, value in entries.items():
        config.insert_json5(key, json.dumps(value))
    return config


def open_router(settings: BusSettings) -> zenoh.Session:
    """A session that routes between its clients until it is closed.

    Raises InputError as `router_config` does, and where it cannot listen.
    """
    config = router_config(settings)
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        where = f"router {settings.connect[0]}"
        mend = "stop what listens there already, or set router = false"
        raise InputError(where, f"cannot listen ({error})", mend) from None


def is_local(endpoint: str) -> bool:
    """Whether an endpoint (protocol/host:port) is reached from this machine only."""
    found = re.fullmatch(r"(?:tcp|udp|tls|quic|ws)/\[?(.+?)\]?:\d+", endpoint)
    return found is not None and is_loopback(found[1])


def main() -> None:
    """Route until SIGTERM or Ctrl-C."""
    parser = argparse.ArgumentParser(prog="wayline-router", description=__doc__)
    parser.add_argument("--config", type=Path, required=True, help="the services' file")
    path: Path = parser.parse_args().config
    try:
        with ending_on_signals() as ending:
            settings = load_settings(path).bus
            with open_router(settings):
                sys.stdout.write(f"routing at {settings.connect[0]}\n")
                sys.stdout.flush()
                ending.wait()
    except InputError as error:
        sys.stderr.write(f"wayline-router: {error}\n")
        sys.exit(2)


if __name__ == "__main__":
    main()
