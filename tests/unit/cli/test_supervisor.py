"""Processes kept running: the state machine under a fake clock, the loop with tiny processes."""

import os
import queue
import signal
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from wayline.ending import Ending
from wayline.errors import InputError
from wayline.settings import load_settings
from wayline_cli.supervisor import GRACE_S, STEADY_S, Action, Order, Supervisor
from wayline_cli.up import Child, children, keep_running, line_writer

STAGES = (("router",), ("gps", "fusion", "eta"))
WAIT_S = 10.0


def started(*stages: tuple[str, ...]) -> Supervisor:
    """A supervisor whose processes all run since 0 s."""
    supervisor = Supervisor(stages or STAGES)
    supervisor.orders(0.0)
    return supervisor


def test_everything_starts_at_once_in_order_and_only_once() -> None:
    supervisor = Supervisor(STAGES)
    names = ["router", "gps", "fusion", "eta"]
    assert supervisor.orders(0.0) == [Order(Action.START, name) for name in names]
    assert supervisor.orders(100.0) == []


def test_what_ends_starts_again_after_its_delay() -> None:
    supervisor = started()
    assert supervisor.ended("gps", 1, 20.0) == pytest.approx(0.2)
    assert supervisor.orders(20.1) == []
    assert supervisor.orders(20.21) == [Order(Action.START, "gps")]
    assert supervisor.orders(20.3) == []


def delays(lives_s: list[float]) -> list[float]:
    """Delays before each restart of a process that lives so long each time."""
    supervisor, now_s = Supervisor([("gps",)]), 0.0
    found: list[float] = []
    for life_s in lives_s:
        assert supervisor.orders(now_s) == [Order(Action.START, "gps")]
        now_s += life_s
        delay_s = supervisor.ended("gps", 1, now_s)
        assert delay_s is not None
        found.append(delay_s)
        now_s += delay_s + 0.001
    return found


def test_the_delay_doubles_up_to_five_seconds() -> None:
    expected = [0.2, 0.4, 0.8, 1.6, 3.2, 5.0, 5.0]
    assert delays([1.0] * 7) == pytest.approx(expected)


def test_a_long_life_resets_the_delay() -> None:
    lives_s = [1.0, 1.0, 1.0, STEADY_S, 1.0, STEADY_S - 0.1, 1.0]
    assert delays(lives_s) == pytest.approx([0.2, 0.4, 0.8, 0.2, 0.4, 0.8, 1.6])


def test_stopping_ends_the_services_in_reverse_and_the_router_last() -> None:
    supervisor = started()
    supervisor.stop()
    assert supervisor.orders(1.0) == [
        Order(Action.TERMINATE, name) for name in ("eta", "fusion", "gps")
    ]
    for name in ("eta", "gps"):
        assert supervisor.ended(name, 1, 1.1) is None
    assert supervisor.orders(1.2) == []
    assert supervisor.ended("fusion", 1, 1.3) is None
    assert not supervisor.is_over
    assert supervisor.orders(1.4) == [Order(Action.TERMINATE, "router")]
    assert supervisor.ended("router", 1, 1.5) is None
    assert supervisor.is_over


def test_what_does_not_end_in_time_is_killed_once() -> None:
    supervisor = started(("gps", "eta"))
    supervisor.stop()
    supervisor.orders(1.0)
    supervisor.ended("eta", 1, 1.5)
    assert supervisor.orders(1.0 + GRACE_S - 0.1) == []
    assert supervisor.orders(1.0 + GRACE_S) == [Order(Action.KILL, "gps")]
    assert supervisor.orders(2.0 + GRACE_S) == []
    assert not supervisor.is_over


def test_what_waits_for_its_restart_is_not_started_when_stopped() -> None:
    supervisor = started(("gps",))
    supervisor.ended("gps", 1, 1.0)
    supervisor.stop()
    assert supervisor.orders(100.0) == []
    assert supervisor.is_over


def test_what_needs_mending_is_left_down_whatever_else_runs() -> None:
    supervisor = started()
    assert supervisor.ended("gps", 2, 1.0) is None
    assert supervisor.orders(100.0) == []
    assert supervisor.down == ["gps"]
    assert supervisor.ended("eta", 2, 101.0) is None
    assert supervisor.orders(200.0) == []
    assert not supervisor.is_over


def test_when_no_service_is_left_the_router_is_ended() -> None:
    supervisor = started()
    for name in ("gps", "eta", "fusion"):
        supervisor.ended(name, 2, 1.0)
    assert supervisor.orders(1.1) == [Order(Action.TERMINATE, "router")]
    supervisor.ended("router", -15, 1.2)
    assert supervisor.is_over
    assert supervisor.down == ["gps", "fusion", "eta"]


def test_it_is_not_over_before_it_is_stopped() -> None:
    supervisor = started(("gps",))
    supervisor.ended("gps", 1, 1.0)
    assert not supervisor.is_over


class Running:
    """`keep_running` in a thread, with the lines that its processes say."""

    def __init__(self, *stages: list[Child]) -> None:
        self.stop = Ending()
        self.lines: queue.SimpleQueue[tuple[str, str]] = queue.SimpleQueue()
        self._down: list[str] = []
        self._thread = threading.Thread(target=self._run, args=(stages,))
        self._thread.start()

    def _run(self, stages: Sequence[Sequence[Child]]) -> None:
        self._down = keep_running(stages, self.stop, lambda *said: self.lines.put(said))

    def down(self) -> list[str]:
        """What needs mending, once all has ended by itself."""
        self._thread.join(WAIT_S)
        assert not self._thread.is_alive()
        return self._down

    def line(self, start: str = "") -> tuple[str, str]:
        """The next line that starts so, and whose it is."""
        while True:
            name, line = self.lines.get(timeout=WAIT_S)
            if line.startswith(start):
                return name, line

    def end(self) -> list[tuple[str, str]]:
        """Stop everything; the lines that were left."""
        self.stop.request()
        self._thread.join(WAIT_S)
        assert not self._thread.is_alive()
        left = []
        while not self.lines.empty():
            left.append(self.lines.get())
        return left


@pytest.fixture
def run() -> Iterator[type[Running]]:
    """Starts processes that are gone after the test."""
    made: list[Running] = []

    class Kept(Running):
        def __init__(self, *stages: list[Child]) -> None:
            super().__init__(*stages)
            made.append(self)

    yield Kept
    for running in made:
        running.end()


SERVICE = "import os, signal; print('pid', os.getpid(), flush=True); signal.pause()"
STUBBORN = f"import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN); {SERVICE}"


def fake(name: str, code: str = SERVICE) -> Child:
    """A service that says its process id and waits for a signal."""
    return Child(name, (sys.executable, "-c", code))


def pid_of(running: Running) -> int:
    """The process id that the next fake service says."""
    return int(running.line("pid")[1].split()[1])


def test_a_killed_service_is_back_within_three_seconds(run: type[Running]) -> None:
    running = run([fake("fusion")])
    first = pid_of(running)
    killed_s = time.monotonic()
    os.kill(first, signal.SIGKILL)
    assert running.line()[1] == "was ended by SIGKILL, starts again in 0.2 s"
    assert pid_of(running) != first
    assert time.monotonic() - killed_s < 3.0


def test_lines_come_with_their_service_errors_included(run: type[Running]) -> None:
    code = "import sys; sys.stderr.buffer.write(b'oh \\xfe\\n'); " + SERVICE
    running = run([fake("eta"), fake("gps", code)])
    said = {running.line(), running.line(), running.line()}
    assert {name for name, line in said if line.startswith("pid")} == {"eta", "gps"}
    assert [name for name, line in said if line.startswith("oh")] == ["gps"]


def test_all_end_when_stopped_the_first_stage_last(run: type[Running]) -> None:
    running = run([fake("router")], [fake("gps"), fake("eta")])
    pids = [pid_of(running) for _ in range(3)]
    left = running.end()
    assert [line for _, line in left] == ["was ended by SIGTERM"] * 3
    assert left[-1][0] == "router"
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


def test_a_service_that_ignores_the_signal_is_killed(
    run: type[Running], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wayline_cli.supervisor.GRACE_S", 0.2)
    running = run([fake("gps", STUBBORN)])
    pid_of(running)
    assert [line for _, line in running.end()] == ["does not end, killed", "was ended by SIGKILL"]


def test_a_service_that_ends_by_itself_says_its_status(run: type[Running]) -> None:
    running = run([fake("gps", "raise SystemExit(3)")])
    assert running.line("ended") == ("gps", "ended with status 3, starts again in 0.2 s")
    assert running.line("ended") == ("gps", "ended with status 3, starts again in 0.4 s")


MENDING = "ended with status 2: needs mending, is not started again"


def test_what_needs_mending_is_said_once_and_left(run: type[Running]) -> None:
    running = run([fake("gps", "raise SystemExit(2)"), fake("eta")])
    assert {running.line()[0], running.line()[0]} == {"gps", "eta"}
    # longer than a first delay
    time.sleep(0.5)
    assert running.end() == [("eta", "was ended by SIGTERM")]


def test_when_all_need_mending_the_router_ends_too(run: type[Running]) -> None:
    broken = "raise SystemExit(2)"
    running = run([fake("router")], [fake("gps", broken), fake("eta", broken)])
    assert {running.line("ended"), running.line("ended")} == {("gps", MENDING), ("eta", MENDING)}
    assert running.line("was ended") == ("router", "was ended by SIGTERM")
    assert running.down() == ["gps", "eta"]


def test_lines_are_written_behind_their_names(capsys: pytest.CaptureFixture[str]) -> None:
    say = line_writer(6)
    say("eta", "hello")
    assert capsys.readouterr().out == "eta    | hello\n"


def configuration(folder: Path, text: str) -> Path:
    """A configuration file."""
    path = folder / "wayline.toml"
    path.write_text(text)
    return path


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A Python with the commands of two services beside it."""
    for name in ("python", "wayline-fusion", "wayline-eta"):
        (tmp_path / name).touch(mode=0o755)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    return tmp_path


def test_the_services_of_the_file_run_after_the_router(installed: Path) -> None:
    path = configuration(installed, 'router = true\nservices = ["fusion", "eta"]')
    stages = children(path, load_settings(path, {}))
    python, config = str(installed / "python"), ("--config", str(path))
    assert stages == [
        [Child("router", (python, "-m", "wayline.router", *config))],
        [
            Child("fusion", (str(installed / "wayline-fusion"), *config)),
            Child("eta", (str(installed / "wayline-eta"), *config)),
        ],
    ]


def test_without_a_router_there_are_only_services(installed: Path) -> None:
    path = configuration(installed, 'services = ["eta"]')
    assert [
        [child.name for child in stage] for stage in children(path, load_settings(path, {}))
    ] == [["eta"]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("router = true", "services is empty; list some"),
        ('services = ["dashboard"]', r"wayline-dashboard: no such command; pip install"),
    ],
)
def test_nothing_to_run_is_named(installed: Path, text: str, message: str) -> None:
    path = configuration(installed, text)
    with pytest.raises(InputError, match=message):
        children(path, load_settings(path, {}))
