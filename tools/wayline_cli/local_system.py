"""Wayline's real processes on this machine, on ports of their own, for checks and tests."""

import json
import os
import socket
import subprocess
import sys
import time
from pathlib import Path

from wayline.services import SERVICES
from wayline.settings import BusSettings
from wayline_cli.up import service_command

STOP_S = 10.0
POLL_S = 0.02


class LocalSystem:
    """Processes that share one configuration, `folder/wayline.toml`; they end with the block.

    `options` are top-level keys of that file. What a process says is in `folder/<name>.log`.
    """

    def __init__(self, folder: Path, **options: object) -> None:
        bus_port, *ports = free_ports(1 + len(SERVICES))
        self.folder = folder
        self.bus = BusSettings(connect=(f"tcp/127.0.0.1:{bus_port}",))
        self.ports = dict(zip(SERVICES, ports, strict=True))
        self.config = self.write_config("wayline.toml", **options)
        self._processes: dict[str, subprocess.Popen[bytes]] = {}

    def __enter__(self) -> "LocalSystem":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End every process."""
        # the router goes last, so that services end without looking for it
        for process in reversed(self._processes.values()):
            process.terminate()
            try:
                process.wait(STOP_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def write_config(self, name: str, **options: object) -> Path:
        """Write another configuration on this system's bus and ports; its path."""
        # JSON's strings, booleans and lists are TOML's
        lines = [f"{key} = {json.dumps(value)}" for key, value in options.items()]
        lines += ["[bus]", f"connect = {json.dumps(self.bus.connect)}"]
        lines += ["[ports]", *(f"{service} = {port}" for service, port in self.ports.items())]
        path = self.folder / name
        path.write_text("\n".join(lines) + "\n")
        return path

    def start_router(self) -> None:
        """Start the router; returns when it routes."""
        command = (sys.executable, "-m", "wayline.router", "--config", str(self.config))
        self.start_command("router", command)
        self.await_said("router", "routing at", STOP_S)

    def start(self, service: str, *arguments: str, config: Path | None = None) -> None:
        """Start a service by its command, with more arguments than its configuration."""
        command = service_command(service, config or self.config)
        self.start_command(service, (*command, *arguments))

    @staticmethod
    def command(service: str) -> tuple[str, ...]:
        """A service's command without arguments."""
        return service_command(service, Path())[:1]

    def start_command(self, name: str, command: tuple[str, ...]) -> None:
        """Start any process under a name; what it says replaces what one before it said."""
        alone = {key: value for key, value in os.environ.items() if not key.startswith("WAYLINE_")}
        with (self.folder / f"{name}.log").open("wb") as log:
            self._processes[name] = subprocess.Popen(  # noqa: S603 - our own, without a shell
                command,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                env={**alone, "PYTHONUNBUFFERED": "1"},
            )

    def pid(self, name: str) -> int:
        """The process's id."""
        return self._processes[name].pid

    def is_running(self, name: str) -> bool:
        """Whether a process that was started has not ended."""
        return self._processes[name].poll() is None

    def stop(self, name: str, timeout_s: float = STOP_S) -> int:
        """End a process by SIGTERM; its exit status. Raises TimeoutExpired."""
        self._processes[name].terminate()
        return self.await_end(name, timeout_s)

    def kill(self, name: str) -> None:
        """End a process as a crash would."""
        self._processes[name].kill()
        self._processes[name].wait()

    def await_end(self, name: str, timeout_s: float = STOP_S) -> int:
        """The exit status of a process that ends by itself. Raises TimeoutExpired."""
        return self._processes[name].wait(timeout_s)

    def said(self, name: str) -> str:
        """What a process has said so far."""
        return (self.folder / f"{name}.log").read_text(errors="replace")

    def await_said(self, name: str, words: str, timeout_s: float) -> None:
        """Wait until a process has said some words. Raises TimeoutError with what it said."""
        deadline_s = time.monotonic() + timeout_s
        while words not in self.said(name):
            if time.monotonic() > deadline_s or self._processes[name].poll() is not None:
                raise TimeoutError(f"{name} did not say {words!r}: {self.said(name)}")
            time.sleep(POLL_S)

    def url(self, service: str) -> str:
        """Where a service answers over HTTP."""
        return f"http://127.0.0.1:{self.ports[service]}"


def free_ports(count: int) -> list[int]:
    """Ports that nothing listens on, all different."""
    probes = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [int(probe.getsockname()[1]) for probe in probes]
    for probe in probes:
        probe.close()
    return ports
