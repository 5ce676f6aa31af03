"""`wayline up`: runs the services that a configuration file lists, and the router if it says so."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from wayline.ending import Ending, ending_on_signals
from wayline.errors import InputError
from wayline.services import SERVICES
from wayline.settings import Settings, load_settings
from wayline_cli.supervisor import NEEDS_MENDING, Action, Supervisor

POLL_S = 0.05
LAST_WORDS_S = 0.2
Say = Callable[[str, str], None]
"""Shows one line of a process, given its name; called from several threads."""


class Child(NamedTuple):
    """A process to keep running."""

    name: str
    command: tuple[str, ...]


class Running(NamedTuple):
    """A process that runs, and the thread that passes on what it says."""

    process: subprocess.Popen[str]
    speaker: threading.Thread


def up(config: Path) -> None:
    """Run what the file lists until SIGTERM or Ctrl-C.

    Raises InputError for a file that does not fit, for a service that is not installed, and when
    every service has ended because it needs mending.
    """
    stages = children(config, load_settings(config))
    names = [child.name for stage in stages for child in stage]
    with ending_on_signals() as ending:
        down = keep_running(stages, ending, line_writer(max(map(len, names))))
        if down and not ending.requested:
            mend = "mend what each has said, then start again"
            raise InputError(str(config), f"no service is left, {', '.join(down)} ended", mend)


def children(config: Path, settings: Settings) -> list[list[Child]]:
    """The processes in the order of starting: the router alone, then the services as listed.

    Raises InputError where there is nothing to run or a service's command is missing.
    """
    if not settings.services:
        mend = 'list some, e.g. services = ["gps-ingest", "fusion"]'
        raise InputError(str(config), "services is empty", mend)
    services = [Child(name, service_command(name, config)) for name in settings.services]
    if not settings.router:
        return [services]
    router = (sys.executable, "-m", "wayline.router", "--config", str(config))
    return [[Child("router", router)], services]


def service_command(name: str, config: Path) -> tuple[str, ...]:
    """How to run a service: its command stands beside this Python."""
    executable = Path(sys.executable).with_name(SERVICES[name].command)
    if not os.access(executable, os.X_OK):
        raise InputError(str(executable), "no such command", f'pip install "wayline[{name}]"')
    return (str(executable), "--config", str(config))


def line_writer(width: int) -> Say:
    """Writes lines to standard output behind their process's name."""
    lock = threading.Lock()

    def say(name: str, line: str) -> None:
        # services go on when nobody reads what they say
        with lock, suppress(BrokenPipeError):
            sys.stdout.write(f"{name:<{width}} | {line}\n")
            sys.stdout.flush()

    return say


def keep_running(stages: Sequence[Sequence[Child]], ending: Ending, say: Say) -> list[str]:
    """Start processes, restart what ends, end them all when asked to stop.

    Returns the names of those that were left down because they need mending.
    """
    commands = {child.name: child.command for stage in stages for child in stage}
    supervisor = Supervisor([[child.name for child in stage] for stage in stages])
    running: dict[str, Running] = {}
    try:
        while not supervisor.is_over:
            if ending.requested:
                supervisor.stop()
            _carry_out(supervisor, commands, running, say)
            _notice_ends(supervisor, running, say)
            _pause(ending)
    finally:
        for process, _ in running.values():
            process.kill()
            process.wait()
    return supervisor.down


def _carry_out(
    supervisor: Supervisor,
    commands: dict[str, tuple[str, ...]],
    running: dict[str, Running],
    say: Say,
) -> None:
    for action, name in supervisor.orders(time.monotonic()):
        if action is Action.START:
            running[name] = _start(name, commands[name], say)
        elif action is Action.TERMINATE:
            running[name].process.terminate()
        else:
            say(name, "does not end, killed")
            running[name].process.kill()


def _start(name: str, command: tuple[str, ...], say: Say) -> Running:
    process = subprocess.Popen(  # noqa: S603 - commands of ours, without a shell
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
        # Ctrl-C on a terminal reaches its whole group; the order of ending is ours to keep
        process_group=0,
    )
    speaker = threading.Thread(target=_pass_on, args=(name, process, say), daemon=True)
    speaker.start()
    return Running(process, speaker)


def _pass_on(name: str, process: subprocess.Popen[str], say: Say) -> None:
    if process.stdout is None:
        return
    with process.stdout as output:
        for line in output:
            say(name, line.rstrip("\n"))


def _notice_ends(supervisor: Supervisor, running: dict[str, Running], say: Say) -> None:
    for name, (process, speaker) in list(running.items()):
        status = process.poll()
        if status is None:
            continue
        del running[name]
        # its last words come first, unless a process of its own still holds the pipe
        speaker.join(LAST_WORDS_S)
        delay_s = supervisor.ended(name, status, time.monotonic())
        say(name, f"{_ending(status)}{_consequence(status, delay_s)}")


def _consequence(status: int, delay_s: float | None) -> str:
    if status == NEEDS_MENDING:
        return ": needs mending, is not started again"
    return "" if delay_s is None else f", starts again in {delay_s:.1f} s"


def _ending(status: int) -> str:
    if status >= 0:
        return f"ended with status {status}"
    return f"was ended by {signal.Signals(-status).name}"


def _pause(ending: Ending) -> None:
    if ending.requested:
        time.sleep(POLL_S)
    else:
        ending.wait(POLL_S)
