"""Headless Chromium for the page, and the page's server with a view that a test can fill."""

import shutil
import time
from collections.abc import Iterator

import msgspec
import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from browser.shuttle import SECOND_NS, Shuttle
from wayline.http_server import HttpServer
from wayline.http_settings import HttpSettings
from wayline.messages import Message
from wayline.view import Receipt
from wayline_dashboard.app import create_dashboard
from wayline_dashboard.live_view import LiveView
from wayline_dashboard.page import NOT_BUILT, STATIC
from wayline_dashboard.view import FleetView

NAMES = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = [
    "--no-sandbox",
    # the map needs WebGL, which a machine without a graphics card draws in software
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One browser for a file of tests; each page has a fresh profile.

    Not for the session: its event loop would stay in the thread of the tests that come after.
    """
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        pytest.skip("Chromium is missing: apt-get install chromium")
    if not (STATIC / "index.html").is_file():
        pytest.skip(NOT_BUILT)
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=path, args=OPTIONS)
        yield started
        started.close()


class Watched:
    """A page and everything that went wrong in it."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.complaints: list[str] = []
        self.requested: set[str] = set()
        self.views: list[FleetView] = []
        page.on("console", self._note_console)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.requested.add(request.url))
        page.on("websocket", lambda line: line.on("framereceived", self._note_view))

    def told_whole(self) -> list[str]:
        """Vehicles of which the page was told the horizon, one by one."""
        return [
            vehicle.vehicle_id
            for view in self.views
            for vehicle in view.vehicles
            if vehicle.horizon is not None
        ]

    def _note_view(self, text: str | bytes) -> None:
        self.views.append(msgspec.json.decode(text, type=FleetView))

    def _note_console(self, message: object) -> None:
        kind, text = getattr(message, "type", ""), getattr(message, "text", "")
        if kind in {"error", "warning"}:
            self.complaints.append(f"{kind}: {text}")


@pytest.fixture
def watched(browser: Browser) -> Iterator[Watched]:
    """A desktop page."""
    context = browser.new_context(viewport={"width": 1000, "height": 700}, locale="en-GB")
    context.set_default_timeout(15_000)
    yield Watched(context.new_page())
    context.close()


class Stage:
    """A shuttle that can be driven, and the server that shows it; the server can be restarted."""

    def __init__(self) -> None:
        self.shuttle = Shuttle(time.time_ns() - 60 * SECOND_NS, outage=range(90, 10_000))
        self.clock_step_ns = 0
        self.live = LiveView(wall_ns=lambda: time.time_ns() + self.clock_step_ns)
        self.settings = HttpSettings(port=0)
        self.server = self._make()

    def drive(self, first: int, last: int, vehicle_id: str = "shuttle-1") -> None:
        """Put a vehicle's steps from `first` up to `last` on the bus."""
        for step in range(first, last):
            for message, source in self.shuttle.messages(step):
                self.put(vehicle_id, message, source)

    def put(
        self, vehicle_id: str, message: Message, source: str, *, recorded: bool = False
    ) -> None:
        """Put a message on the bus, as old as it is; one of a recording is as new as it comes."""
        age_ns = 0 if recorded else max(time.time_ns() - message.t_ns, 0)
        self.live.put(vehicle_id, message, source, Receipt(time.monotonic_ns(), age_ns))

    def catch_up(self, step: int) -> None:
        """Put a step on the bus as if it were now; loading a page takes a while."""
        self.shuttle.start_ns = time.time_ns() - step * SECOND_NS // 10
        self.drive(step, step + 1)

    def start(self) -> None:
        """Serve."""
        self.server.start()
        self.settings = msgspec.structs.replace(self.settings, port=self.server.port)

    def stop(self) -> None:
        """Stop serving."""
        self.server.stop()

    def restart(self, **changes: object) -> None:
        """Serve again where it was served before, with changed settings."""
        self.settings = msgspec.structs.replace(self.settings, **changes)
        self.server = self._make()
        self.server.start()

    def _make(self) -> HttpServer:
        app = create_dashboard(self.live, self.settings, routes=[self.shuttle.route])
        return HttpServer(app, self.settings)


@pytest.fixture
def stage() -> Iterator[Stage]:
    """A stage with a minute driven."""
    made = Stage()
    made.drive(0, 600)
    made.start()
    yield made
    made.stop()
