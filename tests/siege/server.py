"""A PostgreSQL that is away at the start, stops and freezes: `server.py --seconds 60`."""

import argparse
import json
import tempfile
import time
import urllib.request
from pathlib import Path

from postgres import Cluster, programs
from siege.rig import BACK_S, POLL_S, Rig, holes_s
from wayline_cli.local_system import LocalSystem

HOLE_MAX_S = 4.5
"""A run that was lost leaves a hole of five seconds; where roads meet there are smaller ones."""
SILENT_S = 5.0
"""A frozen server is called silent after three seconds."""


def server_away(folder: Path, cluster: Cluster, seconds: float) -> None:
    """A vehicle drives while its server is away at first, stopped, and frozen, so long each."""
    url = cluster.new_url()
    cluster.stop()
    with Rig(folder, url) as rig, _reading(folder, rig) as reads:
        with rig.poses_go_on():
            rig.await_detail("fusion", lambda detail: "database away" in detail)
            rig.await_detail("slope-map", lambda detail: "database away" in detail)
            time.sleep(seconds)
        cluster.start()
        print(f"server there at last: well after {rig.await_well():.1f} s")
        rig.await_runs(1)
        _await_shown(rig, reads)
        with rig.poses_go_on():
            cluster.stop("immediate")
            rig.await_detail("slope-map", lambda detail: "database away" in detail)
            time.sleep(seconds)
        cluster.start()
        print(f"server stopped and back: well after {rig.await_well():.1f} s")
        before = rig.runs()
        cluster.freeze()
        try:
            with rig.poses_go_on():
                rig.await_detail("slope-map", lambda detail: "database silent" in detail)
                time.sleep(max(seconds - SILENT_S, 0.0))
        finally:
            cluster.thaw()
        print(f"server frozen and back: well after {rig.await_well():.1f} s")
        rig.await_runs(len(before) + 1)
        runs = rig.runs()
        assert before == runs[: len(before)]
        assert max(holes_s(runs), default=0.0) < HOLE_MAX_S
        print(f"{len(runs)} runs kept, longest hole {max(holes_s(runs), default=0.0):.1f} s")


def _reading(folder: Path, rig: Rig) -> LocalSystem:
    """Another slope-map on the same database, which began when that was away too."""
    (folder / "reads").mkdir()
    system = LocalSystem(folder / "reads")
    system.bus = rig.system.bus
    options = {"vehicle_id": "bus-8", "database_url": rig.url, "database_refresh_s": 1.0}
    system.start("slope-map", config=system.write_config("reads.toml", **options))
    return system


def _await_shown(rig: Rig, reads: LocalSystem) -> None:
    """Wait until one process shows the roads that the other has learned."""
    begun_s = time.monotonic()
    while not (there := _roads(rig.system)) or not there <= _roads(reads):
        assert time.monotonic() - begun_s < BACK_S, "another process's roads are not shown"
        time.sleep(POLL_S)
    print(f"{len(there)} roads of another process shown after {time.monotonic() - begun_s:.1f} s")


def _roads(system: LocalSystem) -> set[str]:
    with urllib.request.urlopen(f"{system.url('slope-map')}/v1/roads", timeout=BACK_S) as answer:
        return {road["road_id"] for road in json.loads(answer.read())["roads"]}


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="how long each time")
    options = parser.parse_args()
    found = programs()
    if found is None:
        raise SystemExit("siege: no PostgreSQL (Debian: apt-get install postgresql)")
    cluster = Cluster(found)
    try:
        with tempfile.TemporaryDirectory() as folder:
            server_away(Path(folder), cluster, options.seconds)
    finally:
        cluster.close()


if __name__ == "__main__":
    main()
