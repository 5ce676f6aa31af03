"""A vehicle whose server is cut off, frozen or flooded drives on as if it were alone."""

import contextlib
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from lasting import lasting_s
from siege.circling import VEHICLE, Circling
from siege.rig import BACK_S, poses_go_on
from siege.test_flood import flood
from wayline.bus import open_session
from wayline_cli.listener import Listener
from wayline_cli.local_system import LocalSystem

ROUTER = Path(__file__).parents[1] / "vehicle_router.py"
START_S = 40.0
SHORT_S = 1.0
FLOODERS = 2
FLOOD_MORE_S = 30.0
"""A flooder's own start and end on a busy machine."""


@pytest.fixture(autouse=True)
def busy_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """Short forms run beside other tests, which hold up everybody for longer."""
    if not lasting_s(0.0):
        monkeypatch.setattr("siege.rig.GAP_MAX_S", 1.0)


class Linked:
    """A vehicle with its own router and fusion, a server's router, and what both sides hear."""

    def __init__(self, folder: Path) -> None:
        for side in ("server", "vehicle"):
            (folder / side).mkdir()
        self.server = LocalSystem(folder / "server", vehicles=["*"])
        self.vehicle = LocalSystem(folder / "vehicle", vehicle_id=VEHICLE)

    @contextlib.contextmanager
    def driving(self) -> Iterator[None]:
        """Everything runs, and the server hears the vehicle."""
        with contextlib.ExitStack() as stack:
            stack.enter_context(self.server)
            self.server.start_router()
            stack.enter_context(self.vehicle)
            self._start_own_router()
            self.vehicle.start("fusion")
            session = stack.enter_context(open_session(self.vehicle.bus))
            self.near = Listener(session, VEHICLE, ("pose", "health"))
            stack.callback(self.near.close)
            self.near.await_alive("fusion", timeout_s=START_S)
            self.circling = stack.enter_context(Circling(session))
            self.near.await_message("pose", timeout_s=START_S)
            self.far = Listener(
                stack.enter_context(open_session(self.server.bus)), VEHICLE, ("pose",)
            )
            stack.callback(self.far.close)
            self.far.await_message("pose", timeout_s=START_S)
            yield

    def _start_own_router(self) -> None:
        port = self.vehicle.bus.connect[0].rpartition(":")[2]
        command = (sys.executable, str(ROUTER), port, self.server.bus.connect[0])
        self.vehicle.start_command("router", command)
        self.vehicle.await_said("router", "routing", START_S)

    def await_heard_far(self) -> float:
        """Wait until the server hears poses of now; seconds that took."""
        since_s, since_ns = time.monotonic(), time.time_ns()
        heard = self.far.await_message(
            "pose", lambda each: each.message.t_ns > since_ns, timeout_s=START_S
        )
        return heard.received_s - since_s

    @contextlib.contextmanager
    def cut(self) -> Iterator[None]:
        """The server is gone while the block runs."""
        self.server.kill("router")
        yield
        self.server.start_router()

    @contextlib.contextmanager
    def frozen(self) -> Iterator[None]:
        """The server takes and says nothing while the block runs."""
        pid = self.server.pid("router")
        os.kill(pid, signal.SIGSTOP)
        yield
        os.kill(pid, signal.SIGCONT)

    @contextlib.contextmanager
    def flooded(self) -> Iterator[None]:
        """Others flood the server, unpaced, while the block runs."""
        names = [f"flood-{number}" for number in range(FLOODERS)]
        for name in names:
            flood(self.server, name, lasting_s(SHORT_S), 0.0, 0)
        yield
        for name in names:
            assert self.server.await_end(name, lasting_s(SHORT_S) + FLOOD_MORE_S) == 0


@pytest.fixture(scope="module")
def linked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Linked]:
    """A vehicle that its server hears."""
    made = Linked(tmp_path_factory.mktemp("linked"))
    with made.driving():
        yield made


@pytest.mark.parametrize("fault", [Linked.cut, Linked.frozen, Linked.flooded])
def test_whatever_becomes_of_the_server_the_vehicle_has_its_poses(
    linked: Linked, fault: Callable[[Linked], contextlib.AbstractContextManager[None]]
) -> None:
    with fault(linked), poses_go_on(linked.near, linked.circling):
        time.sleep(lasting_s(SHORT_S))
    back_s = linked.await_heard_far()
    print(f"{fault.__name__}: the server hears it again after {back_s:.2f} s")
    assert back_s < BACK_S
    assert linked.vehicle.is_running("fusion")
