"""The doctor's checks of the machine: packages, the page, Node.js, disk, clock."""

import datetime as dt
import shutil
import subprocess
from collections.abc import Callable, Iterable
from importlib.util import find_spec
from pathlib import Path

from wayline.services import SERVICES
from wayline_cli.check import Check, fine, note, wrong

OPTIONAL = {
    "asammdf": ("mf4", "MF4 recordings"),
    "pyrtklib5": ("raw", "raw measurements of u-blox receivers and RINEX"),
    "rerun": ("rerun", "live views in Rerun"),
}
"""Module, its extra and what it is for."""
NODE_NEEDED = "Node.js 20.19, 22.12 or newer"
NODE_TIMEOUT_S = 5.0
LOW_BYTES, SCARCE_BYTES = 2_000_000_000, 200_000_000
EARLIEST = dt.datetime(2026, 1, 1, tzinfo=dt.UTC)
"""This program is younger; a clock without battery starts in 1970 or at its last shutdown."""
LATEST = dt.datetime(2100, 1, 1, tzinfo=dt.UTC)

Has = Callable[[str], bool]


def is_installed(module: str) -> bool:
    """Whether a module could be imported."""
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:
        # the package that it would be part of
        return False


def check_packages(services: Iterable[str], *, rerun_wanted: bool, has: Has) -> list[Check]:
    """Packages of the services, then the optional ones."""
    checks = [_service_packages(service, has) for service in services]
    for module, (extra, purpose) in OPTIONAL.items():
        subject, mend = f"package {module}", f'pip install "wayline[{extra}]"'
        if has(module):
            checks.append(fine(subject, f"installed, for {purpose}"))
        elif module == "rerun" and rerun_wanted:
            checks.append(wrong(subject, "rerun.enabled is set, it is not installed", mend))
        else:
            checks.append(note(subject, f"not installed, no {purpose}", mend))
    return checks


def _service_packages(service: str, has: Has) -> Check:
    subject = f"packages of {service}"
    missing = [module for module in SERVICES[service].modules if not has(module)]
    if missing:
        return wrong(subject, f"{', '.join(missing)} missing", f'pip install "wayline[{service}]"')
    return fine(subject, "installed")


def check_page(index: Path, node: str | None) -> list[Check]:
    """The dashboard's page, and whether this machine could build it.

    `node` is what `node --version` says, None without Node.js.
    """
    is_built = index.is_file()
    can_build = node is not None and is_node_enough(node)
    install = f"install {NODE_NEEDED}, then run scripts/setup"
    if is_built:
        page = fine("page", "built")
    else:
        mend = "run scripts/setup" if can_build else install
        page = wrong("page", "not built, the dashboard has none to show", mend)
    found = node or "not installed"
    if can_build:
        return [page, fine("Node.js", found)]
    why = "needed only to build the page" if is_built else "the page cannot be built"
    return [page, note("Node.js", f"{found}; {why}", install)]


def is_node_enough(version: str) -> bool:
    """Whether "v22.12.0" can build the page."""
    parts = version.strip().removeprefix("v").split(".")
    if len(parts) < 2 or not all(part.isdigit() for part in parts[:2]):
        return False
    major, minor = int(parts[0]), int(parts[1])
    return major > 22 or (major, minor) >= (22, 12) or (major == 20 and minor >= 19)


def node_version() -> str | None:
    """What `node --version` says; None without Node.js."""
    path = shutil.which("node")
    if path is None:
        return None
    try:
        found = subprocess.run(  # noqa: S603 - a fixed command
            (path, "--version"), capture_output=True, text=True, timeout=NODE_TIMEOUT_S, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return found.stdout.strip() or None


def check_disk(folder: Path, free_bytes: int) -> Check:
    """Room for databases and recordings."""
    subject, finding = f"disk of {folder}", f"{free_bytes / 1e9:,.1f} GB free"
    if free_bytes < SCARCE_BYTES:
        return wrong(subject, finding, "make room, databases and recordings will fail")
    if free_bytes < LOW_BYTES:
        return note(subject, finding, "make room soon")
    return fine(subject, finding)


def check_clock(now: dt.datetime) -> Check:
    """Whether the wall clock can be right; poses and arrivals carry it."""
    finding = f"{now:%Y-%m-%d %H:%M:%S} UTC"
    if EARLIEST <= now < LATEST:
        return fine("clock", finding)
    return wrong("clock", f"{finding} cannot be", "set it, e.g. timedatectl set-ntp true")
