"""A vehicle's own router, which reports to a server's: PORT SERVER_ENDPOINT; ends with SIGTERM."""

import json
import sys
from pathlib import Path

import zenoh

from wayline.ending import ending_on_signals

CONFIG = Path(__file__).parents[1] / "deploy/zenoh/vehicle.json5"


def main(port: str, server: str) -> None:
    """Route as deploy/zenoh/vehicle.json5 says, but for addresses and passwords."""
    config = zenoh.Config.from_file(str(CONFIG))
    entries = {
        "listen/endpoints": [f"tcp/127.0.0.1:{port}"],
        "connect/endpoints": [server],
        "transport/auth/usrpwd": {},
    }
    for key, value in entries.items():
        config.insert_json5(key, json.dumps(value))
    with ending_on_signals() as ending, zenoh.open(config):
        sys.stdout.write("routing\n")
        sys.stdout.flush()
        ending.wait()


if __name__ == "__main__":
    main(*sys.argv[1:])
