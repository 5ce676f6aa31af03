"""What processes have spent and hold, by name."""

from collections.abc import Mapping
from typing import NamedTuple

import psutil


class Costs(NamedTuple):
    """CPU seconds since each process's start and its resident memory."""

    cpu_s: dict[str, float]
    memory_bytes: dict[str, int]


def costs(pids: Mapping[str, int]) -> Costs:
    """Costs of now. Raises psutil.NoSuchProcess for one that has ended."""
    processes = {name: psutil.Process(pid) for name, pid in pids.items()}
    times = {name: process.cpu_times() for name, process in processes.items()}
    return Costs(
        {name: each.user + each.system for name, each in times.items()},
        {name: process.memory_info().rss for name, process in processes.items()},
    )


def core_shares(before: Costs, after: Costs, elapsed_s: float) -> dict[str, float]:
    """CPU seconds a second of each process between two readings."""
    return {name: (after.cpu_s[name] - spent) / elapsed_s for name, spent in before.cpu_s.items()}
