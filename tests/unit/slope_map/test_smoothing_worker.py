"""Runs are smoothed beside the messages, and come to what they come to in a replay."""

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from unit.slope_map.hilly_road import core, drive, driven_of
from wayline.database import open_database
from wayline.patient_store import PatientStore, Tables
from wayline.settings import Settings
from wayline_slope_map import smoothing_worker
from wayline_slope_map.export import export_rows
from wayline_slope_map.records import DrivenRun, FinishedRun
from wayline_slope_map.run import smoothed_runs
from wayline_slope_map.smoothing_process import SmoothingProcess
from wayline_slope_map.smoothing_worker import Smoother, SmoothingWorker
from wayline_slope_map.store import SlopeStore, SlopeTables

PACKAGE = "wayline_slope_map"


class Here:
    """Smooths in the worker's thread, by a function."""

    def __init__(self, smoothed: Callable[[DrivenRun], list[FinishedRun]]) -> None:
        self.smoothed = smoothed

    def close(self) -> None:
        """Nothing was begun."""


@pytest.fixture(scope="module")
def driven() -> DrivenRun:
    (run,) = driven_of(core(), drive(seed=1, length_m=1_500.0))
    return run


@pytest.fixture
def process() -> Iterator[SmoothingProcess]:
    begun = SmoothingProcess()
    yield begun
    begun.close()


def worker_at(
    folder: Path, begin: Callable[[], Smoother] = SmoothingProcess, capacity: int = 10
) -> SmoothingWorker:
    tables = Tables(f"sqlite:///{folder}/live.db", PACKAGE, SlopeTables)
    return SmoothingWorker(PatientStore(tables, Settings()), capacity, begin)


def test_another_process_comes_to_the_same_to_the_last_bit(
    driven: DrivenRun, process: SmoothingProcess
) -> None:
    assert process.smoothed(driven) == smoothed_runs(driven)
    assert process.smoothed(driven) == smoothed_runs(driven)


def test_what_is_kept_live_is_what_a_replay_keeps(driven: DrivenRun, tmp_path: Path) -> None:
    worker = worker_at(tmp_path, lambda: Here(smoothed_runs))
    worker.start(lambda: None)
    assert worker.save(driven) == ()
    worker.close()
    SlopeStore(open_database(f"sqlite:///{tmp_path}/replay.db", PACKAGE)).save(driven)
    live, replayed = (
        list(export_rows(open_database(f"sqlite:///{tmp_path}/{name}.db", PACKAGE)))
        for name in ("live", "replay")
    )
    assert live == replayed
    assert len(live) > 70


def test_whoever_hands_a_run_over_does_not_wait(driven: DrivenRun, tmp_path: Path) -> None:
    at_work, go_on = threading.Event(), threading.Event()

    def slow(run: DrivenRun) -> list[FinishedRun]:
        at_work.set()
        go_on.wait(8.0)
        return smoothed_runs(run)

    worker = worker_at(tmp_path, lambda: Here(slow))
    worker.start(lambda: None)
    began = time.monotonic()
    worker.save(driven)
    assert at_work.wait(10.0)
    worker.save(driven)
    assert time.monotonic() - began < 5.0
    go_on.set()
    worker.close()


def test_a_run_that_takes_too_long_does_not_hold_the_end_up(
    driven: DrivenRun,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setattr(smoothing_worker, "CLOSE_S", 0.2)
    go_on = threading.Event()

    def slow(_: DrivenRun) -> list[FinishedRun]:
        go_on.wait(10.0)
        return []

    worker = worker_at(tmp_path, lambda: Here(slow))
    worker.start(lambda: None)
    worker.save(driven)
    worker.close()
    assert "could not be smoothed in time" in caplog.text
    go_on.set()


def test_runs_that_find_no_room_are_told_of(driven: DrivenRun, tmp_path: Path) -> None:
    full = worker_at(tmp_path, capacity=2)
    for _ in range(3):
        full.save(driven)
    assert full.detail == "runs lost: 1, too many waited to be smoothed"


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_smoothing_that_dies_ends_the_process(driven: DrivenRun, tmp_path: Path) -> None:
    def broken(run: DrivenRun) -> list[FinishedRun]:
        raise ZeroDivisionError(run.vehicle_id)

    worker, failed = worker_at(tmp_path, lambda: Here(broken)), threading.Event()
    worker.start(failed.set)
    worker.save(driven)
    assert failed.wait(10.0)
    with pytest.raises(RuntimeError, match="died"):
        worker.close()


def test_a_process_that_was_killed_is_told_of(driven: DrivenRun, process: SmoothingProcess) -> None:
    process.close()
    with pytest.raises((RuntimeError, ValueError)):
        process.smoothed(driven)
