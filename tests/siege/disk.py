"""A disk that is full or read-only, at the start and in the middle: `disk.py --seconds 30`."""

import argparse
import contextlib
import resource
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from siege.rig import STORES, Rig, holes_s
from siege.server import HOLE_MAX_S

DISK_BYTES = 4_000_000
PIECE = bytes(4096)
Fault = Callable[[Path, "SmallDisk", float], None]


class SmallDisk:
    """A file system in memory with room for little."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._filler = folder / "filler"
        folder.mkdir()
        self._mount("-t", "tmpfs", "-o", f"size={DISK_BYTES}", "tmpfs")

    def close(self) -> None:
        """Take it away."""
        subprocess.run(("umount", str(self.folder)), check=True)

    @contextlib.contextmanager
    def full(self) -> Iterator[None]:
        """Without room while the block runs."""
        with contextlib.suppress(OSError), self._filler.open("wb", buffering=0) as filler:
            while filler.write(PIECE):
                pass
        yield
        self._filler.unlink()

    @contextlib.contextmanager
    def read_only(self) -> Iterator[None]:
        """Read only while the block runs; refused while a file is open for writing."""
        self._mount("-o", "remount,ro", "tmpfs")
        yield
        self._mount("-o", "remount,rw", "tmpfs")

    def _mount(self, *arguments: str) -> None:
        subprocess.run(("mount", *arguments, str(self.folder)), check=True, capture_output=True)


@contextlib.contextmanager
def small_disk(folder: Path) -> Iterator[SmallDisk | None]:
    """A small disk, None where mounting is not allowed."""
    try:
        disk = SmallDisk(folder)
    except (subprocess.CalledProcessError, FileNotFoundError):
        yield None
        return
    try:
        yield disk
    finally:
        disk.close()


@contextlib.contextmanager
def no_room_for(pids: list[int]) -> Iterator[None]:
    """No file of some processes may grow while the block runs: a full disk for them alone."""
    before = [resource.prlimit(pid, resource.RLIMIT_FSIZE) for pid in pids]
    for pid, (_, hard) in zip(pids, before, strict=True):
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (0, hard))
    yield
    for pid, limits in zip(pids, before, strict=True):
        resource.prlimit(pid, resource.RLIMIT_FSIZE, limits)


def full_in_the_middle(folder: Path, seconds: float) -> None:
    """A vehicle drives while nothing can be written, by the processes' own limits."""
    with Rig(folder, f"sqlite:///{folder}/wayline.db") as rig:
        rig.await_runs(1)
        _suffer(rig, "limit", no_room_for([rig.system.pid(name) for name in STORES]), seconds)
        _check_kept(rig)


def full(folder: Path, disk: SmallDisk, seconds: float) -> None:
    """A vehicle drives while its disk is full at the start and in the middle."""
    with _started_in(disk.full(), folder / "full", disk, seconds) as rig:
        rig.await_runs(1)
        _suffer(rig, "full", disk.full(), seconds)
        rig.await_runs(len(rig.runs()) + 1)
        _check_kept(rig)


def read_only(folder: Path, disk: SmallDisk, seconds: float) -> None:
    """A vehicle drives while its disk, with a database on it, is read-only at the start."""
    with _started_in(disk.read_only(), folder / "read-only", disk, seconds) as rig:
        rig.await_runs(len(rig.runs()) + 1)
        assert rig.integrity() == "ok"


@contextlib.contextmanager
def _started_in(
    fault: contextlib.AbstractContextManager[object], folder: Path, disk: SmallDisk, seconds: float
) -> Iterator[Rig]:
    """Services that began while there was a fault, after it."""
    folder.mkdir()
    with contextlib.ExitStack() as end:
        end.enter_context(fault)
        with Rig(folder, f"sqlite:///{disk.folder}/wayline.db") as rig:
            _suffer(rig, f"{folder.name} at the start", end.pop_all(), seconds)
            yield rig


def _suffer(
    rig: Rig, name: str, fault: contextlib.AbstractContextManager[object], seconds: float
) -> None:
    with fault, rig.poses_go_on():
        rig.await_detail("slope-map", lambda detail: "database away" in detail)
        time.sleep(seconds)
    print(f"disk {name}: well after {rig.await_well():.1f} s")


def _check_kept(rig: Rig) -> None:
    runs = rig.runs()
    assert rig.integrity() == "ok"
    assert max(holes_s(runs), default=0.0) < HOLE_MAX_S
    print(f"{len(runs)} runs kept, longest hole {max(holes_s(runs), default=0.0):.1f} s")


def siege(folder: Path, seconds: float, faults: Sequence[Fault] = (full, read_only)) -> None:
    """The disk's faults as far as this machine allows."""
    with small_disk(folder / "disk") as disk:
        if disk is not None:
            for fault in faults:
                fault(folder, disk, seconds)
            return
    print("mounting is not allowed here: files that may not grow stand for a full disk")
    full_in_the_middle(folder, seconds)


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=30.0, help="how long each time")
    options = parser.parse_args()
    for each in (siege, full_in_the_middle):
        with tempfile.TemporaryDirectory() as folder:
            each(Path(folder), options.seconds)


if __name__ == "__main__":
    main()
