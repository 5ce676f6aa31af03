"""What a database that is killed, full or away costs: nothing that was kept, and gaps are told."""

import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import sqlalchemy as sa

from builders import at
from postgres import Cluster
from unit.history.driven import VEHICLE, kept_of, legs
from unit.history.keeping import FOREVER, History
from wayline.patient_store import PatientStore, Tables
from wayline.settings import Settings
from wayline.spool import Waiting
from wayline_history.kept import HistoryTables, Openings
from wayline_history.losses import Losses
from wayline_history.records import Event, Piece
from wayline_history.store import Alive

WAIT_S = 20.0
SETTINGS = Settings(database_retry_s=0.1, database_refresh_s=0.1)
EVER = (0, 2**62)

WRITER = """
import sys
from postgres import Cluster
from unit.history.driven import kept_of, legs
from unit.history.keeping import History

history = History(sys.argv[1])
for number in range(10_000):
    history.keep(legs((10, 10.0), start_s=10.0 * number))
    print(number, flush=True)
"""


class Running:
    """A history's store at work."""

    def __init__(self, url: str, capacity: int = 1_000) -> None:
        losses, openings = Losses(), Openings()
        tables = Tables(
            url,
            "wayline_history",
            lambda engine: HistoryTables(engine, FOREVER, losses, openings),
        )
        self.store = PatientStore(tables, SETTINGS, capacity=capacity, on_lost=losses.note)
        self.store.start(lambda: None)

    def put(self, start_s: float, vehicle_id: str = VEHICLE) -> None:
        """What ten seconds of a drive make."""
        for piece in kept_of(legs((10, 10.0), start_s=start_s)).pieces:
            self.store.put(vehicle_id, piece)


Run = Callable[..., Running]
Open = Callable[[str], History]


@pytest.fixture
def run() -> Iterator[Run]:
    started: list[Running] = []

    def start(url: str, **options: int) -> Running:
        started.append(Running(url, **options))
        return started[-1]

    yield start
    for running in started:
        running.store.close()


def await_that(holds: Callable[[], bool]) -> None:
    deadline_s, pause = time.monotonic() + WAIT_S, threading.Event()
    while not holds():
        assert time.monotonic() < deadline_s
        pause.wait(0.05)


def gaps(history: History, vehicle_id: str = VEHICLE) -> list[Event]:
    return [each for each in history.reader.events(vehicle_id, *EVER, 10_000) if each.kind == "gap"]


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_nothing_acknowledged_is_lost_by_a_kill(
    database_url: str, seed: int, open_history: Open
) -> None:
    tests = Path(__file__).parents[2]
    command = (sys.executable, "-c", WRITER, database_url)
    with subprocess.Popen(command, stdout=subprocess.PIPE, cwd=tests, text=True) as writer:
        assert writer.stdout is not None
        for _ in range(random.Random(seed).randrange(3, 15)):
            writer.stdout.readline()
        writer.send_signal(signal.SIGKILL)
        acknowledged = [int(line) for line in writer.stdout]
    history = open_history(database_url)
    kept = history.times_s()
    assert len(kept) >= 10 * (max(acknowledged, default=2) + 1)
    assert kept == pytest.approx(list(range(len(kept))))
    assert len(kept) % 10 == 0


@pytest.mark.parametrize(("is_whole", "on_its_way_s"), [(True, 0), (False, 10)])
def test_a_history_that_was_not_running_says_so(
    database_url: str, run: Run, open_history: Open, is_whole: bool, on_its_way_s: int
) -> None:
    """A process that was killed lost what its cores had not handed over yet, too."""
    history = open_history(database_url)
    an_hour_ago_ns = time.time_ns() - 3_600 * 10**9
    history.keep(legs((10, 10.0)))
    history.store.save([], Alive(an_hour_ago_ns, is_whole))
    run(database_url)
    await_that(lambda: len(gaps(history)) == 1)
    (gap,) = gaps(history)
    assert (gap.detail, gap.name) == ("history was not running", "history")
    assert gap.t_ns == an_hour_ago_ns - on_its_way_s * 10**9
    assert gap.until_ns is not None
    assert gap.until_ns > an_hour_ago_ns + 3_500 * 10**9


def test_a_service_that_ends_leaves_nothing_on_its_way(
    database_url: str, run: Run, open_history: Open
) -> None:
    running = run(database_url)
    running.put(0.0)
    running.store.close()
    alive = open_history(database_url).store.alive()
    assert alive is not None
    assert alive.is_whole


def test_what_waits_for_a_database_that_is_away_is_kept_when_it_is_back(
    tmp_path: Path, run: Run, open_history: Open
) -> None:
    folder = tmp_path / "mounted-later"
    running = run(f"sqlite:///{folder}/history.db")
    for start_s in range(0, 100, 10):
        running.put(start_s)
    assert "away" in (running.store.problem or "")
    folder.mkdir()
    await_that(lambda: running.store.problem is None)
    history = open_history(f"sqlite:///{folder}/history.db")
    await_that(lambda: len(history.times_s()) == 100)
    assert gaps(history) == []


def test_what_found_no_room_to_wait_is_told_as_a_gap(
    tmp_path: Path, run: Run, open_history: Open
) -> None:
    folder = tmp_path / "mounted-later"
    running = run(f"sqlite:///{folder}/history.db", capacity=4)
    for start_s in range(0, 100, 10):
        running.put(start_s)
    folder.mkdir()
    history_url = f"sqlite:///{folder}/history.db"
    await_that(lambda: running.store.problem is None)
    history = open_history(history_url)
    await_that(lambda: len(gaps(history)) == 1)
    (gap,) = gaps(history)
    kept = history.times_s()
    assert (gap.t_ns, gap.name) == (at(0), "lost")
    assert gap.until_ns is not None
    # each second is kept or in the gap
    assert gap.until_ns < at(kept[0])
    assert len(kept) >= 20
    assert kept[-1] == pytest.approx(99)


def test_a_full_disk_costs_nothing_that_was_kept(
    tmp_path: Path, run: Run, open_history: Open
) -> None:
    url = f"sqlite:///{tmp_path}/history.db"
    running = run(url)
    running.put(0.0)
    history = open_history(url)
    await_that(lambda: len(history.times_s()) == 10)
    is_full = threading.Event()

    @sa.event.listens_for(sa.Engine, "before_cursor_execute")
    def refuse(connection, cursor, statement, *_) -> None:  # type: ignore[no-untyped-def]
        if is_full.is_set() and statement.startswith("INSERT INTO history_chunk"):
            cursor.execute("PRAGMA max_page_count = 1")
            pages = cursor.execute("PRAGMA page_count").fetchone()[0]
            cursor.execute("CREATE TABLE filler AS SELECT zeroblob(?) AS b", (pages * 65_536,))

    try:
        is_full.set()
        running.put(10.0)
        await_that(lambda: "full" in (running.store.problem or ""))
        assert history.times_s() == pytest.approx(list(range(10)))
        is_full.clear()
        await_that(lambda: len(history.times_s()) == 20)
        assert running.store.problem is None
    finally:
        sa.event.remove(sa.Engine, "before_cursor_execute", refuse)


def test_losses_that_cannot_be_told_of_yet_are_told_of_later() -> None:
    losses = Losses()
    (piece,) = kept_of(legs((5, 10.0))).pieces
    losses.note(Waiting(VEHICLE, piece))
    told = losses.take()
    assert losses.take() == []
    losses.put_back(told)
    assert losses.take() == told


def test_a_batch_with_a_record_that_is_refused_costs_that_one_only(
    postgres: Cluster, run: Run, open_history: Open
) -> None:
    url = postgres.new_url()
    running = run(url)
    running.put(0.0)
    # PostgreSQL's texts hold no zero
    bad = Event(t_ns=at(5), kind="gap", name="a\x00b")
    running.store.put(VEHICLE, Piece(events=(bad,)))
    running.put(10.0)
    history = open_history(url)
    await_that(lambda: len(history.times_s()) == 20)
    await_that(lambda: [each.name for each in gaps(history)] == ["lost"])
