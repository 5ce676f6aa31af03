"""Smooths runs in a process of its own: in a thread the messages of two seconds would wait for it.

`python -m wayline_slope_map.smoothing_process` reads driven runs and writes what each comes to,
until its input ends; it ends with whoever began it, however that ends.
"""

import os
import pickle
import subprocess
import sys
from typing import BinaryIO

from wayline_slope_map.left_out import LeftOut
from wayline_slope_map.records import DrivenRun, FinishedRun
from wayline_slope_map.run import outcome

NICENESS = 5
"""On a machine of one core messages go first."""


class SmoothingProcess:
    """The other end of such a process, which is begun with it: its imports take a second."""

    def __init__(self) -> None:
        # a session of its own: Ctrl-C is for the service, which then lets it finish
        self._process = subprocess.Popen(
            [sys.executable, "-m", "wayline_slope_map.smoothing_process"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,
        )

    def smoothed(self, driven: DrivenRun) -> list[FinishedRun | LeftOut]:
        """What a run comes to; waits for it. Raises RuntimeError if the process has died."""
        source, sink = self._process.stdout, self._process.stdin
        if source is None or sink is None:
            raise RuntimeError("a process without pipes")
        try:
            pickle.dump(driven, sink)
            sink.flush()
            found: list[FinishedRun | LeftOut] = pickle.load(source)  # noqa: S301 - our own process's
        except (EOFError, BrokenPipeError):
            raise RuntimeError("the smoothing of a run died, its traceback is above") from None
        return found

    def close(self) -> None:
        """End it, whatever it is at."""
        self._process.kill()
        self._process.communicate()


def serve(source: BinaryIO, sink: BinaryIO) -> None:
    """Smooth one run after the other until there is none."""
    while source.peek(1):  # type: ignore[attr-defined]  # of a buffered reader
        driven: DrivenRun = pickle.load(source)  # noqa: S301 - our own process's
        pickle.dump(outcome(driven), sink)
        sink.flush()


def main() -> None:
    """Serve whoever began this process."""
    os.nice(NICENESS)
    serve(sys.stdin.buffer, sys.stdout.buffer)


if __name__ == "__main__":
    main()
