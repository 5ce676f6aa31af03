"""What it takes to smooth and merge a run, beside bare filterpy, and what messages notice of it."""

import time
from collections.abc import Callable
from pathlib import Path
from threading import Event, Thread

import numpy as np
from filterpy.kalman import KalmanFilter

from wayline.database import open_database
from wayline.messages import Pose
from wayline.node import Node
from wayline.patient_store import PatientStore, Tables
from wayline.settings import Settings
from wayline.tuning import Tuning
from wayline.vertical.model import VerticalModel
from wayline_bench.rounds import Say, in_turns
from wayline_bench.row import Row, compared
from wayline_bench.slope_map import driven_run, poses
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.records import DrivenRun
from wayline_slope_map.smoothing_worker import SmoothingWorker
from wayline_slope_map.store import SlopeStore, SlopeTables

PACKAGE = "wayline_slope_map"
RUN_M = 50_000.0
MERGE_BAR = 3.0
ROUNDS = 3
DELAY_BAR_MS = 20.0
"""A fifth of the time from pose to pose."""
POSES_HZ = 50.0
WATCHED_S = 8.0


def merge_rows(folder: Path, say: Say) -> list[Row]:
    """CPU of a merge, and how late messages are handled while a run is smoothed beside them."""
    say("a drive of 50 km")
    run = driven_run(RUN_M)
    return [_merge_row(run, folder, say), _delay_row(run, folder, say)]


def _merge_row(run: DrivenRun, folder: Path, say: Say) -> Row:
    fresh = iter(range(ROUNDS + 1))
    size = nodes_of(run)

    def merge() -> None:
        url = f"sqlite:///{folder}/merge-{next(fresh)}.db"
        SlopeStore(open_database(url, PACKAGE)).save(run)

    spent_s = in_turns({"merge": merge, "bare": lambda: bare_pass(size)}, ROUNDS, say)
    return compared(
        "smooth and merge a run of 50 km", spent_s["merge"], spent_s["bare"],
        f"a filterpy pass and its RTS, {size} steps", unit="s", bar=MERGE_BAR,
    )  # fmt: skip


def nodes_of(run: DrivenRun) -> int:
    """Places of a run at which something is measured or asked."""
    track = run.track
    measured = (track.altitudes, track.pressures, track.pushes, track.own_slopes)
    asked = sum(len(stretch.bins()[0]) for stretch in run.stretches)
    return sum(len(each) for each in measured) + asked


def bare_pass(steps: int) -> None:
    """A filter of as many states as the vertical model's, one number a step, and its smoother."""
    model = VerticalModel(Tuning())
    kalman = KalmanFilter(dim_x=model.size, dim_z=1)
    kalman.x, kalman.P = model.first()
    kalman.F, kalman.Q = model.transition(4.0, 0.2)
    kalman.H = np.zeros((1, model.size))
    kalman.H[0, 0] = 1.0
    means = np.empty((steps, model.size))
    covariances = np.empty((steps, model.size, model.size))
    for step in range(steps):
        kalman.predict()
        kalman.update(500.0)
        means[step], covariances[step] = kalman.x, kalman.P
    kalman.rts_smoother(means, covariances)


def _delay_row(run: DrivenRun, folder: Path, say: Say) -> Row:
    """The slowest hundredth of messages, with a run being smoothed all the while and without."""
    tables = Tables(f"sqlite:///{folder}/delay.db", PACKAGE, SlopeTables)
    worker = SmoothingWorker(PatientStore(tables, Settings()))
    worker.start(lambda: None)
    try:
        say("messages alone")
        alone_ms = _slowest_ms(lambda: None)
        say("messages beside a run")
        beside_ms = _slowest_ms(lambda: worker.save(run))
    finally:
        worker.close()
    what = f"a message's delay (p99), alone {alone_ms:.1f} ms, beside a run"
    return compared(what, [beside_ms], [DELAY_BAR_MS], "allowed", unit="ms", bar=1.0)


def _slowest_ms(beside: Callable[[], object]) -> float:
    """From when each pose was due to when the core was done with it, the slowest hundredth."""
    core = SlopeMapCore(KnownRoads(), Tuning(), "bench")
    node, late_ms, done = Node("slope-map", core), list[float](), Event()

    def handle() -> None:
        began_s = time.monotonic()
        for count, pose in enumerate(poses(0, RUN_M)):
            due_s = began_s + count / POSES_HZ
            if count / POSES_HZ > WATCHED_S:
                break
            time.sleep(max(due_s - time.monotonic(), 0.0))
            _take(node, pose)
            late_ms.append(1e3 * (time.monotonic() - due_s))
        done.set()

    beside()
    Thread(target=handle, daemon=True).start()
    done.wait()
    return float(np.quantile(late_ms, 0.99))


def _take(node: Node, pose: Pose) -> None:
    for _ in node.take(pose, "fusion"):
        pass
