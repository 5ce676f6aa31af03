"""A PostgreSQL of the tests' own: a cluster in a folder, on a port of loopback, gone afterwards."""

import itertools
import os
import pwd
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path

import psycopg

from wayline_cli.local_system import free_ports

START_S = 30
DEBIAN = Path("/usr/lib/postgresql")
NAMES = itertools.count()


def programs() -> Path | None:
    """The folder with the server's programs; None where it is not installed."""
    found = shutil.which("pg_ctl")
    if found is not None:
        return Path(found).parent
    folders = sorted(DEBIAN.glob("*/bin"), key=lambda path: int(path.parent.name))
    return folders[-1] if folders else None


class Cluster:
    """A server that can be stopped, killed, frozen and started again."""

    def __init__(self, bin_folder: Path) -> None:
        self._bin = bin_folder
        self._folder = Path(tempfile.mkdtemp(prefix="wayline-postgres-"))
        self._data = self._folder / "data"
        # the server refuses to run as root
        self._user = "postgres" if os.geteuid() == 0 else None
        if self._user is not None:
            os.chown(self._folder, pwd.getpwnam(self._user).pw_uid, -1)
        (self.port,) = free_ports(1)
        self._run("initdb", "--auth=trust", "--username=wayline", "--encoding=UTF8", "--no-sync")
        self.start()

    def start(self) -> None:
        """Start the server; returns when it takes connections."""
        # fsync matters to a machine that loses its power, not to a server that is killed
        settings = ("listen_addresses=127.0.0.1", "unix_socket_directories=''", "fsync=off")
        options = f"-p {self.port} " + " ".join(f"-c {setting}" for setting in settings)
        log = str(self._folder / "log")
        self._run("pg_ctl", "start", "-w", "-t", str(START_S), "-l", log, "-o", options)

    def stop(self, mode: str = "fast") -> None:
        """Stop it; `immediate` is as a crash would."""
        self._run("pg_ctl", "stop", "-w", "-m", mode)

    def freeze(self) -> None:
        """Let nothing of it run, its connections stay open."""
        self._signal(signal.SIGSTOP)

    def thaw(self) -> None:
        """Let it run on."""
        self._signal(signal.SIGCONT)

    def new_url(self) -> str:
        """The address of a new, empty database."""
        name = f"test_{next(NAMES)}"
        with psycopg.connect(self._address("postgres"), autocommit=True) as connection:
            connection.execute(f"CREATE DATABASE {name}")
        return self._address(name)

    def close(self) -> None:
        """End it, if it runs, and remove its folder."""
        if (self._data / "postmaster.pid").exists():
            self.stop("immediate")
        shutil.rmtree(self._folder)

    def _address(self, name: str) -> str:
        return f"postgresql://wayline@127.0.0.1:{self.port}/{name}"

    def _signal(self, number: signal.Signals) -> None:
        """The server, then each of its processes, so that none is started meanwhile."""
        main = int((self._data / "postmaster.pid").read_text().split()[0])
        os.kill(main, number)
        for child in Path(f"/proc/{main}/task/{main}/children").read_text().split():
            os.kill(int(child), number)

    def _run(self, program: str, *arguments: str) -> None:
        command = (str(self._bin / program), "-D", str(self._data), *arguments)
        said = self._folder / "said"
        # a pipe would stay open as long as the server runs
        with said.open("ab") as output:
            done = subprocess.run(
                command,
                user=self._user,
                cwd=self._folder,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                check=False,
            )
        if done.returncode:
            raise RuntimeError(said.read_text())
