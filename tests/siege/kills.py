"""Services killed -9 at random moments while they write: `kills.py --times 20`."""

import argparse
import random
import tempfile
import time
from pathlib import Path

from siege.rig import START_S, STORES, Rig

SPEED = 20.0
"""Times as fast as driven: a run every 0.3 s, what fusion keeps every 3 s."""
LIFE_S = (0.2, 4.0)
"""Between a service's start and its death."""


def killed(folder: Path, times: int, seed: int) -> None:
    """Each store's service dies so often; what the database once had it always has."""
    dice = random.Random(seed)
    with Rig(folder, f"sqlite:///{folder}/wayline.db", speed=SPEED) as rig:
        rig.await_runs(1)
        runs = rig.runs()
        for service in [each for _ in range(times) for each in STORES]:
            time.sleep(dice.uniform(*LIFE_S))
            before = rig.runs(), rig.saved_ns()
            rig.system.kill(service)
            assert rig.integrity() == "ok"
            assert set(before[0]) <= set(rig.runs()), "a run that was kept is gone"
            assert rig.saved_ns() >= before[1], "what fusion had kept is gone"
            rig.listener.await_alive(service, up=False, timeout_s=START_S)
            rig.system.start(service)
            rig.listener.await_alive(service, timeout_s=START_S)
        rig.await_well()
        rig.await_runs(len(rig.runs()) + 1)
        print(f"{times} deaths each: {len(rig.runs()) - len(runs)} runs more, integrity ok")


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", type=int, default=20, help="how often each service dies")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        killed(Path(folder), options.times, options.seed)


if __name__ == "__main__":
    main()
