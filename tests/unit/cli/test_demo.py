"""The demo's choices: ports, files, what it prints; its processes are in tests/integration."""

import json
import socket
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from threading import Thread

import pytest

from wayline.drive_file import load_drive
from wayline.ending import Ending
from wayline.errors import InputError
from wayline.services import SERVICES
from wayline.settings import load_settings
from wayline_cli import demo_files, demo_ready
from wayline_cli.demo import addresses, demo, has_display
from wayline_cli.demo_files import TRUCK_GPS, Demo, Ports, check_ports, choose_ports, prepare
from wayline_cli.demo_ready import await_live, missing
from wayline_cli.journal import journal_in


def test_without_a_wish_the_ports_are_the_services_own() -> None:
    ports = choose_ports(None)
    assert ports.http == {**{name: row.port for name, row in SERVICES.items()}, TRUCK_GPS: 8007}
    assert (ports.router, ports.rerun) == (7447, 9876)


def test_a_first_port_moves_everything_in_a_row() -> None:
    assert sorted(choose_ports(18_000).all().values()) == list(range(18_000, 18_010))


@pytest.mark.parametrize("first", [0, 80, 65_530])
def test_a_first_port_without_room_is_refused(first: int) -> None:
    with pytest.raises(InputError, match="--first-port"):
        choose_ports(first)


def test_a_taken_port_is_named_with_the_mend() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=rf"port {port} \(eta\).*--first-port"):
            check_ports(Ports({"eta": port}, 0, 0))
    check_ports(Ports({"eta": port}, 0, 0))


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("nan")])
def test_a_run_of_no_length_is_refused(seconds: float) -> None:
    with pytest.raises(InputError, match="--seconds"):
        demo(seconds=seconds)


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Demo]:
    """A demo that could start, and its folder."""
    folder = tmp_path_factory.mktemp("demo")
    return folder, prepare(folder, choose_ports(18_000))


def test_every_process_has_a_configuration_that_loads(prepared: tuple[Path, Demo]) -> None:
    _, ready = prepared
    commands = [child.command for stage in ready.stages for child in stage]
    assert len(commands) == 9
    for command in commands:
        path = Path(command[command.index("--config") + 1])
        settings = load_settings(path, {})
        assert settings.vehicles == ("*",)
        assert settings.bus.connect == (f"tcp/127.0.0.1:{ready.ports.router}",)
        assert all(Path(route).is_file() for route in settings.routes)


def test_every_process_listens_where_the_demo_looks(prepared: tuple[Path, Demo]) -> None:
    _, ready = prepared
    found = {}
    for child in ready.stages[1]:
        path = Path(child.command[child.command.index("--config") + 1])
        service = Path(child.command[0]).name.removeprefix("wayline-")
        found[child.name] = load_settings(path, {}).http_of(service).port
    assert found == ready.ports.http


def test_the_slopes_have_the_trucks_road_and_the_arrivals_both_routes(
    prepared: tuple[Path, Demo],
) -> None:
    folder, _ = prepared
    assert len(load_settings(folder / "wayline.toml", {}).routes) == 2
    assert load_settings(folder / "slope-map.toml", {}).routes == (
        str(folder / "demo-truck" / "route.geojson"),
    )


def test_fusion_and_the_slopes_know_what_the_truck_weighs(prepared: tuple[Path, Demo]) -> None:
    folder, _ = prepared
    truck = load_drive(folder / "demo-truck").vehicle
    assert truck.mass_kg > 30_000.0
    for name in ("wayline.toml", "slope-map.toml"):
        assert load_settings(folder / name, {}).vehicle == truck


def test_a_missing_shuttle_is_said_with_the_mend(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(demo_files, "SHUTTLE_FOLDERS", (tmp_path,))
    with pytest.raises(InputError, match="the shuttle's drive is not there; run scripts/demo"):
        prepare(tmp_path, choose_ports(None))


@pytest.mark.parametrize(
    ("environment", "platform", "expected"),
    [
        ({}, "linux", False),
        ({"DISPLAY": ":0"}, "linux", True),
        ({"DISPLAY": ""}, "linux", False),
        ({"WAYLAND_DISPLAY": "wayland-0"}, "linux", True),
        ({}, "darwin", True),
    ],
)
def test_a_page_opens_only_where_it_has_a_window(
    environment: dict[str, str], platform: str, expected: bool
) -> None:
    assert has_display(environment, platform) is expected


def test_the_addresses_are_those_of_the_ports(prepared: tuple[Path, Demo]) -> None:
    _, ready = prepared
    text = "\n".join(addresses(ready, is_built=True))
    for address in (
        "http://127.0.0.1:18000\n",
        "http://127.0.0.1:18001/docs",
        "http://127.0.0.1:18002/docs",
        "rerun+http://127.0.0.1:18009/proxy",
    ):
        assert address in text
    assert "the page is not built" in "\n".join(addresses(ready, is_built=False))


VIEW = {
    "vehicles": [
        {"vehicle_id": "a", "pose": {"lat_deg": 1.0}},
        {"vehicle_id": "b", "pose": {"lat_deg": None}},
        {"vehicle_id": "c"},
    ]
}


class Answering(BaseHTTPRequestHandler):
    """A service that is well, with a view of three vehicles of which one is placed."""

    def do_GET(self) -> None:
        body = json.dumps(VIEW if self.path == "/v1/view" else {}).encode()
        self.send_response(200)
        self.send_header("content-length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: object) -> None:
        """Say nothing."""


def serving(silent_port: int) -> tuple[HTTPServer, Demo]:
    """A dashboard that answers, and a demo of it with an eta on another port."""
    server = HTTPServer(("127.0.0.1", 0), Answering)
    Thread(target=server.serve_forever, daemon=True).start()
    http = {"dashboard": server.server_port, "eta": silent_port or server.server_port}
    return server, Demo(Ports(http, 0, 0), [], frozenset({"a", "b", "c"}), has_rerun=False)


def test_services_that_are_silent_are_missing_before_vehicles() -> None:
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        server, made = serving(closed.getsockname()[1])
        assert missing(made) == ["eta"]
        server.shutdown()
        server.server_close()


def test_vehicles_without_a_place_on_the_page_are_missing() -> None:
    server, made = serving(0)
    assert missing(made) == ["b", "c"]
    server.shutdown()
    server.server_close()


def test_what_is_missing_is_said_after_a_while_and_waiting_can_be_stopped(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(demo_ready, "PATIENCE_S", 0.0)
    server, made = serving(0)
    ending = Ending()
    waiting = await_live(made, ending)
    assert next(waiting) == ["b", "c"]
    ending.request()
    assert list(waiting) == []
    server.shutdown()
    server.server_close()


def test_a_journal_keeps_lines_and_last_words(tmp_path: Path) -> None:
    with journal_in(tmp_path) as journal:
        journal.note("eta", "first")
        journal.note("eta", "last")
        assert journal.last_words(["fusion", "eta"]) == ["eta: last"]
    journal.note("eta", "after the end")
    lines = (tmp_path / "demo.log").read_text().splitlines()
    assert [line.partition(" ")[2] for line in lines] == ["eta | first", "eta | last"]


def test_a_journal_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    with (
        pytest.raises(InputError, match=r"demo\.log: .*name a folder"),
        journal_in(tmp_path / "none"),
    ):
        pass


def test_the_vehicles_are_the_drives(prepared: tuple[Path, Demo]) -> None:
    drives = (demo_files.find_shuttle(), prepared[0] / "demo-truck")
    assert tuple(load_drive(drive).drive.vehicle_id for drive in drives) == demo_files.VEHICLES
