"""What is left to do for a service's process once it has stopped."""

import os
import subprocess
import sys
from pathlib import Path

from wayline_cli.local_system import free_ports

STOPPED = """
import gc, os, signal, sys, threading, time
from wayline_eta.__main__ import main

begun_s = time.process_time()
gc.collect()
collected_s = time.process_time() - begun_s
threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGTERM)).start()
main()
print(collected_s, time.process_time(), flush=True)
"""


def test_a_process_that_has_stopped_is_gone_at_once(tmp_path: Path) -> None:
    """It takes less than a look through all that it has loaded; Python's own end took four.

    On a busy machine that was longer than `wayline up` waits before it kills.
    """
    (port,) = free_ports(1)
    config = tmp_path / "wayline.toml"
    config.write_text(f'[bus]\nconnect = ["tcp/127.0.0.1:{port}"]\n')
    command = [sys.executable, "-c", STOPPED, "--config", str(config)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        collected_s, stopped_s = map(float, process.stdout.read().split())
        _, status, spent = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    assert spent.ru_utime + spent.ru_stime - stopped_s < collected_s
