"""A store that a service can do without for a while: its disk may be full, its server away."""

import itertools
import logging
import queue
import threading
import time
from collections.abc import Callable, Sequence
from typing import Generic, NamedTuple, Protocol, TypeVar, runtime_checkable

import msgspec
import sqlalchemy as sa

from wayline.core import Record
from wayline.database import DatabaseAwayError, open_database, said
from wayline.errors import InputError
from wayline.settings import Settings
from wayline.spool import CAPACITY, Spool, Waiting

FIRST_PAUSE_S = 0.2
ANSWER_S = 2.0
"""A core that starts waits so long for what was kept."""
SLOW_S = 3.0
"""A database that says nothing for so long is not well."""
CLOSE_S = 3.0
"""What the end of the process waits for the last writes; supervisors kill after five seconds."""
WHAT_MAX = 140
BATCH = 500
"""Records that are kept together, where the tables can do that."""

log = logging.getLogger("wayline")


class Kept(Protocol):
    """A service's tables, on an engine; used in the store's thread alone."""

    def save(self, vehicle_id: str, record: Record) -> Sequence[msgspec.Struct]:
        """Keep a record durably before returning what is known from now on."""
        ...

    def look(self) -> Sequence[msgspec.Struct]:
        """What is there and was not told yet: first all, then what other processes wrote."""
        ...


@runtime_checkable
class KeptInBatches(Kept, Protocol):
    """Tables that keep many records at the price of one."""

    def save_all(self, batch: Sequence[Waiting]) -> Sequence[msgspec.Struct]:
        """Keep records durably, all or none, before returning what is known from now on."""
        ...


KeptType = TypeVar("KeptType", bound=Kept)
Found = TypeVar("Found")


class Tables(NamedTuple, Generic[KeptType]):
    """Where the tables of a service are, and what works on them."""

    url: str
    package: str
    """With the migrations, see `open_database`."""
    on_engine: Callable[[sa.Engine], KeptType]


class Question(NamedTuple, Generic[KeptType]):
    """Something to ask the tables in the store's thread."""

    put_to: Callable[[KeptType], None]
    over: threading.Event


class PatientStore(Generic[KeptType]):
    """Keeps records in a thread of its own, so that whoever hands them over never waits.

    A database that cannot be used is tried again, after longer and longer pauses, and records wait
    in a bounded spool meanwhile, in order. `tell` gets what the tables say, in the thread that
    calls `hand_over`; `on_lost` what too many records, or the database's refusal, cost. Raises
    InputError for what only editing mends.
    """

    def __init__(
        self,
        tables: Tables[KeptType],
        settings: Settings,
        tell: Callable[[msgspec.Struct], None] = lambda _: None,
        *,
        newest_only: bool = False,
        capacity: int = CAPACITY,
        on_lost: Callable[[Waiting], None] = lambda _: None,
    ) -> None:
        self._tables, self._tell = tables, tell
        self._retry_s, self._refresh_s = settings.database_retry_s, settings.database_refresh_s
        self._spool = Spool(capacity, newest_only=newest_only, on_lost=on_lost)
        self._lock = threading.Lock()
        """Of the spool."""
        self._questions: queue.SimpleQueue[Question[KeptType]] = queue.SimpleQueue()
        self._news: queue.SimpleQueue[msgspec.Struct] = queue.SimpleQueue()
        self._engine: sa.Engine | None = None
        self._kept: KeptType | None = None
        self._trouble: str | None = None
        """Why the database cannot be used."""
        self._asked_s: float | None = None
        """Since when, by the monotonic clock, an answer is waited for."""
        self._pause_s = FIRST_PAUSE_S
        self._awake, self._ending = threading.Event(), threading.Event()
        self._thread: threading.Thread | None = None
        self._failed: Callable[[], None] = lambda: None
        self._failure: InputError | None = None
        self._died = False
        self._turn()

    def start(self, failed: Callable[[], None]) -> None:
        """Begin to work; `failed` is called, in another thread, if it cannot go on."""
        self._failed = failed
        # a daemon: a server that is frozen must not keep the process
        self._thread = threading.Thread(target=self._run, name="store", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Keep what waits, as far as that is quick. Raises what ended the thread, if it did."""
        self._ending.set()
        self._awake.set()
        if self._thread is not None:
            self._thread.join(CLOSE_S)
        is_at_work = self._thread is not None and self._thread.is_alive()
        if not is_at_work:
            self._let_go()
        if left := len(self._spool):
            log.warning("%d records could not be kept and are lost", left)
        if self._failure is not None:
            raise self._failure
        if self._died and not is_at_work:
            raise RuntimeError("the store died, its traceback is above")

    def of(self, vehicle_id: str) -> "VehicleStore":
        """The store of one vehicle's core."""
        return VehicleStore(self, vehicle_id)

    def put(self, vehicle_id: str, record: Record) -> None:
        """Hand a record over to be kept."""
        with self._lock:
            self._spool.put(Waiting(vehicle_id, record))
        self._awake.set()

    def ask(self, question: Callable[[KeptType], Found | None]) -> Found | None:
        """What the tables answer; None where they do not within a moment."""
        if self.problem is not None:
            return None
        found: list[Found | None] = []
        over = threading.Event()
        self._questions.put(Question(lambda kept: found.append(question(kept)), over))
        self._awake.set()
        over.wait(ANSWER_S)
        return found[0] if found else None

    def hand_over(self) -> None:
        """Tell, in the caller's thread, what the tables have said."""
        while not self._news.empty():
            self._tell(self._news.get())

    @property
    def backlog(self) -> int:
        """How many records wait."""
        return len(self._spool)

    @property
    def problem(self) -> str | None:
        """What is wrong with the database now, in a few words; None where all is well."""
        waiting = f"{len(self._spool)} records wait"
        trouble, asked_s = self._trouble, self._asked_s
        if trouble is not None:
            return f"away ({trouble}), {waiting}"
        if asked_s is not None and time.monotonic() - asked_s > SLOW_S:
            return f"silent, {waiting}"
        return None

    @property
    def detail(self) -> str | None:
        """What `health` should say: the problem, or what it has cost."""
        if (problem := self.problem) is not None:
            return f"database {problem}"
        if (lost := self._spool.lost) > 0:
            return f"{lost} records lost: too many waited, or the database refused them"
        return None

    def _run(self) -> None:
        self._died = True
        try:
            self._work()
            self._died = False
        except InputError as error:
            self._failure, self._died = error, False
        finally:
            self._failed()

    def _work(self) -> None:
        while not self._ending.is_set():
            self._turn()
            if self._trouble is None:
                self._awake.wait(self._refresh_s)
                self._awake.clear()
            else:
                self._ending.wait(self._pause_s)
        self._turn()
        while len(self._spool) and self._trouble is None:
            self._turn()

    def _turn(self) -> None:
        """Do what there is to do, as far as the database lets it."""
        self._asked_s = time.monotonic()
        try:
            kept = self._opened()
            self._answer(kept)
            self._save_all(kept)
            for each in kept.look():
                self._news.put(each)
        except DatabaseAwayError as error:
            self._give_up(error.what)
        except sa.exc.DBAPIError as error:
            self._give_up(said(error))
        else:
            self._be_well()
        finally:
            self._asked_s = None

    def _opened(self) -> KeptType:
        if self._kept is None or self._engine is None:
            self._engine = open_database(self._tables.url, self._tables.package)
            self._kept = self._tables.on_engine(self._engine)
        with self._engine.connect() as connection:
            # where there is nothing to write, that the server is gone would not be noticed
            connection.exec_driver_sql("SELECT 1")
        return self._kept

    def _answer(self, kept: KeptType) -> None:
        while not self._questions.empty():
            question = self._questions.get()
            try:
                question.put_to(kept)
            finally:
                question.over.set()

    def _save_all(self, kept: KeptType) -> None:
        if isinstance(kept, KeptInBatches):
            self._save_batches(kept)
        else:
            self._save_singly(kept)

    def _save_batches(self, kept: KeptInBatches) -> None:
        """Keep one batch; where more wait, questions have their turn before the next."""
        if not (batch := self._oldest()):
            return
        try:
            answers = kept.save_all(batch)
        except (sa.exc.DataError, sa.exc.IntegrityError):
            # one of them is refused; which, is seen when they come one by one
            self._save_singly(kept, len(batch))
        else:
            with self._lock:
                for waiting in batch:
                    self._spool.take_out(waiting)
            for answer in answers:
                self._news.put(answer)
        if len(self._spool):
            self._awake.set()

    def _save_singly(self, kept: Kept, count: int | None = None) -> None:
        """Keep what waits, or so many of it."""
        left = itertools.count() if count is None else range(count)
        for _ in left:
            if (waiting := self._first()) is None:
                return
            self._asked_s = time.monotonic()
            try:
                answers = kept.save(waiting.vehicle_id, waiting.record)
            except (sa.exc.DataError, sa.exc.IntegrityError) as error:
                # it would be refused for ever, and all that come after would wait for it
                log.error("a record of %s is refused: %s", waiting.vehicle_id, said(error))
                with self._lock:
                    self._spool.lose(waiting)
                answers = ()
            with self._lock:
                self._spool.take_out(waiting)
            for answer in answers:
                self._news.put(answer)

    def _oldest(self) -> list[Waiting]:
        with self._lock:
            return self._spool.oldest(BATCH)

    def _first(self) -> Waiting | None:
        with self._lock:
            return self._spool.first()

    def _give_up(self, what: str) -> None:
        """Leave the database alone for a while, each time longer."""
        what = what[:WHAT_MAX]
        if self._trouble is None:
            log.warning("the database cannot be used: %s", what)
            self._pause_s = FIRST_PAUSE_S
        else:
            self._pause_s = min(2.0 * self._pause_s, self._retry_s)
        self._trouble = what
        while not self._questions.empty():
            self._questions.get().over.set()
        self._let_go()

    def _let_go(self) -> None:
        """Close what is open; opened again, the tables are looked at anew."""
        if self._engine is not None:
            self._engine.dispose()
        self._engine = self._kept = None

    def _be_well(self) -> None:
        if self._trouble is not None:
            log.info("the database is used again")
        self._trouble = None


class VehicleStore:
    """What one vehicle's core hands its records to; answers come by `PatientStore.hand_over`."""

    def __init__(self, store: PatientStore[KeptType], vehicle_id: str) -> None:
        self._store, self._vehicle_id = store, vehicle_id

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        """Have a record kept as soon as the database can."""
        self._store.put(self._vehicle_id, record)
        return ()
