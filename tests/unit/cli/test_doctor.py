"""What the doctor finds and says to mend; machine and network are given where they can be."""

import datetime as dt
import json
import socket
import sqlite3
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from threading import Thread

import pytest

from wayline.database import open_database
from wayline.errors import InputError
from wayline.http_settings import HttpSettings
from wayline.live_sources import LiveCan, LiveNmea
from wayline.router import open_router
from wayline.settings import BusSettings, Settings
from wayline_can_ingest.diagnosis.opening import try_can
from wayline_cli import check_network
from wayline_cli.check import Check, Mark, attempted, fine, is_well, note, wrong
from wayline_cli.check_can import check_can
from wayline_cli.check_database import database_finding
from wayline_cli.check_machine import (
    check_clock,
    check_disk,
    check_packages,
    check_page,
    is_node_enough,
    node_version,
)
from wayline_cli.check_network import check_http_ports, check_router, port_holder, try_session
from wayline_cli.doctor import check_vehicle, configured, data_folder, doctor, machine

PACKAGE = "wayline_slope_map"


def by_subject(checks: list[Check] | tuple[Check, ...]) -> dict[str, Check]:
    return {check.subject: check for check in checks}


def test_only_what_is_wrong_spoils_the_verdict() -> None:
    assert is_well([fine("a", "b"), note("c", "d", "e")])
    assert not is_well([fine("a", "b"), wrong("c", "d", "e")])


def test_an_input_error_becomes_a_wrong_line_with_its_mend() -> None:
    def fail() -> str:
        raise InputError("file", "is empty", "fill it")

    assert attempted("x", fail) == wrong("x", "file: is empty", "fill it")
    assert attempted("x", lambda: "good") == fine("x", "good")


def test_a_configuration_that_does_not_load_is_the_first_line(tmp_path: Path) -> None:
    path = tmp_path / "wayline.toml"
    path.write_text("vehicle = 1\n")
    first, *others = doctor(path, {})
    assert first.mark is Mark.WRONG
    assert "vehicle" in first.finding
    assert first.mend
    assert "clock" in by_subject(tuple(others))


ROUTE = """{"type": "FeatureCollection", "features": [{"type": "Feature",
 "properties": {"route_id": "r", "name": "R"},
 "geometry": {"type": "LineString", "coordinates": [[10.0, 55.0], [10.01, 55.0]]}}]}"""


def test_what_the_configuration_names_is_looked_at(tmp_path: Path) -> None:
    (tmp_path / "r.geojson").write_text(ROUTE)
    settings = Settings(
        vehicle_id="bus-1",
        routes=(str(tmp_path / "r.geojson"), str(tmp_path / "none.geojson")),
        database_url=f"sqlite:///{tmp_path}/a.db",
    )
    checks = configured(settings, ["eta", "slope-map"], is_default=False)
    assert [check.mark.value for check in checks] == [
        "fine",
        "fine",
        "fine",
        "wrong",
        "fine",
        "fine",
    ]
    assert [check.subject for check in checks] == [
        "vehicle", "HTTP", "route", "route", "database of eta", "database of slope-map",
    ]  # fmt: skip
    assert checks[2].finding == "r: 640 m, 0 stops"


def test_a_vehicle_without_a_name_is_wrong() -> None:
    assert check_vehicle(Settings(), ["fusion"]).mark is Mark.WRONG
    everyone = Settings(vehicles=("*",))
    assert check_vehicle(everyone, ["fusion"]) == fine("vehicle", "*")
    receiver = LiveNmea(url="serial:///dev/ttyUSB0")
    reading = Settings(vehicles=("*",), nmea=(receiver,))
    assert check_vehicle(reading, ["gps-ingest"]).mark is Mark.WRONG


def test_exposure_without_tokens_is_wrong() -> None:
    settings = Settings(vehicle_id="a", http=HttpSettings(host="0.0.0.0"))
    found = by_subject(tuple(configured(settings, ["eta"], is_default=False)))["HTTP"]
    assert found.mark is Mark.WRONG
    assert "tokens" in found.mend


def test_a_slope_map_without_a_database_is_wrong_once_configured() -> None:
    settings = Settings(vehicle_id="a")
    for is_default, mark in ((True, Mark.NOTE), (False, Mark.WRONG)):
        checks = configured(settings, ["slope-map"], is_default=is_default)
        assert checks[-1].mark is mark


def test_fusion_without_a_database_is_noted() -> None:
    checks = configured(Settings(vehicle_id="a"), ["fusion"], is_default=False)
    assert checks[-1].mark is Mark.NOTE
    assert "calibration" in checks[-1].finding


def test_a_database_is_looked_at_without_writing(tmp_path: Path) -> None:
    path = tmp_path / "a.db"
    url = f"sqlite:///{path}"
    assert "is made when slope-map starts" in database_finding(url, "slope-map", PACKAGE)
    assert not path.exists()
    sqlite3.connect(path).close()
    path.touch()
    assert "makes its tables" in database_finding(url, "slope-map", PACKAGE)
    open_database(url, PACKAGE).dispose()
    assert "up to date" in database_finding(url, "slope-map", PACKAGE)


def revised(path: Path, revision: str) -> str:
    """The address of a database at a revision of another program's age."""
    url = f"sqlite:///{path}"
    open_database(url, PACKAGE).dispose()
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE alembic_version_slope_map SET version_num = ?", (revision,))
    connection.close()
    return url


def test_a_database_of_a_newer_version_is_wrong(tmp_path: Path) -> None:
    url = revised(tmp_path / "a.db", "9999")
    with pytest.raises(InputError, match=r"newer version .*9999"):
        database_finding(url, "slope-map", PACKAGE)


@pytest.mark.parametrize(
    ("url", "what"),
    [
        ("nonsense", "is not a database address"),
        ("mysql://a/b", "is a kind of database that is not known"),
        ("sqlite:////nowhere/at/all.db", "no folder /nowhere/at"),
        ("postgresql://user:secret@127.0.0.1:1/x", "cannot be opened|driver is not installed"),
    ],
)
def test_a_database_that_cannot_be_used_is_wrong(url: str, what: str) -> None:
    with pytest.raises(InputError, match=what) as caught:
        database_finding(url, "slope-map", PACKAGE)
    assert "secret" not in str(caught.value)


def test_a_file_that_is_no_database_is_wrong(tmp_path: Path) -> None:
    (tmp_path / "a.db").write_text("these bytes are no database, however long they go on" * 20)
    with pytest.raises(InputError, match="cannot be opened"):
        database_finding(f"sqlite:///{tmp_path}/a.db", "slope-map", PACKAGE)


SECRETS = [
    ('[http]\ntokens = ["t0ken"]', "http.tokens"),
    ('[bus]\nuser = "a"\npassword = "s3cret"', "bus.password"),
    ('database_url = "postgresql://me:s3cret@127.0.0.1:1/x"', "database_url"),
    ('database_url = "postgresql://127.0.0.1:1/x?password=s3cret"', "database_url"),
]


@pytest.mark.parametrize(("text", "held"), SECRETS)
def test_a_file_with_secrets_that_everybody_may_read_is_noted(
    tmp_path: Path, text: str, held: str
) -> None:
    path = tmp_path / "wayline.toml"
    path.write_text('vehicle_id = "bus-1"\n' + text)
    for mode, mark in ((0o644, Mark.NOTE), (0o640, Mark.FINE)):
        path.chmod(mode)
        found = by_subject(tuple(doctor(path, {})))["secrets"]
        assert found.mark is mark
        assert held in found.finding
        assert "s3cret" not in found.finding
    path.chmod(0o644)
    assert by_subject(tuple(doctor(path, {})))["secrets"].mend == f"chmod o= {path}"


def test_a_file_without_secrets_may_be_read_though_the_environment_has_some(tmp_path: Path) -> None:
    path = tmp_path / "wayline.toml"
    path.write_text('vehicle_id = "bus-1"\n')
    path.chmod(0o644)
    assert "secrets" not in by_subject(tuple(doctor(path, {"WAYLINE_HTTP_TOKEN": "t0ken"})))


def test_a_private_key_that_everybody_may_read_is_noted(tmp_path: Path) -> None:
    key, path = tmp_path / "http.key", tmp_path / "wayline.toml"
    key.write_text("-----BEGIN PRIVATE KEY-----")
    key.chmod(0o644)
    path.write_text(f'vehicle_id = "bus-1"\n[http]\ntls_cert = "{key}"\ntls_key = "{key}"\n')
    found = by_subject(tuple(doctor(path, {})))["secrets"]
    assert (found.mark, found.mend) == (Mark.NOTE, f"chmod o= {key}")


@pytest.mark.parametrize(
    ("holder", "mark", "finding"),
    [
        (None, Mark.FINE, "free"),
        ("eta", Mark.FINE, "wayline eta answers there"),
        ("fusion", Mark.WRONG, "taken by wayline fusion"),
        ("", Mark.WRONG, "taken by another program"),
    ],
)
def test_a_port_is_free_or_its_services_own(holder: str | None, mark: Mark, finding: str) -> None:
    (check,) = check_http_ports(Settings(), ["eta"], lambda *_: holder)
    assert (check.subject, check.mark, check.finding) == ("port 8001 of eta", mark, finding)


class Answering(BaseHTTPRequestHandler):
    """Says on /healthz what its server's `says` holds."""

    says: bytes = b""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("content-length", str(len(self.says)))
        self.end_headers()
        self.wfile.write(self.says)

    def log_message(self, *_: object) -> None:
        """Say nothing."""


@pytest.fixture
def web() -> Iterator[HTTPServer]:
    """A web server of any kind."""
    server = HTTPServer(("127.0.0.1", 0), Answering)
    Thread(target=server.serve_forever, daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


def test_who_holds_a_port_is_asked(web: HTTPServer, monkeypatch: pytest.MonkeyPatch) -> None:
    well = {"ok": True, "service": "eta", "version": "0.1.0"}
    monkeypatch.setattr(Answering, "says", json.dumps(well).encode())
    assert port_holder("127.0.0.1", web.server_port) == "eta"
    monkeypatch.setattr(Answering, "says", b"<html>")
    assert port_holder("127.0.0.1", web.server_port) == ""
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        port = closed.getsockname()[1]
    assert port_holder("127.0.0.1", port) is None


def test_a_router_is_joined_or_given_up_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(check_network, "ROUTER_TIMEOUT_S", 0.5)
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        bus = BusSettings(connect=(f"tcp/127.0.0.1:{closed.getsockname()[1]}",))
    problem = try_session(bus)
    assert problem is not None
    assert "Unable to connect" in problem
    with open_router(bus):
        assert try_session(bus) is None


def test_a_router_that_is_not_there_is_wrong_unless_wayline_up_starts_it() -> None:
    bus = BusSettings()
    for own_router, mark in ((True, Mark.NOTE), (False, Mark.WRONG)):
        check = check_router(bus, own_router=own_router, open_session=lambda _: "refused")
        assert check.mark is mark
        assert check.mend
    there = check_router(bus, own_router=False, open_session=lambda _: None)
    assert there.mark is Mark.FINE


def test_can_interfaces_are_opened() -> None:
    good = LiveCan(interface="virtual", channel="doctor")
    bad = LiveCan(interface="socketcan", channel="nocan7", bitrate=250_000)
    unknown = LiveCan(interface="no-such-thing", channel=0)
    found = check_can([good, bad, unknown], try_can)
    assert [check.mark.value for check in found] == ["fine", "wrong", "wrong"]
    assert "ip link set nocan7 up type can bitrate 250000" in found[1].mend
    assert "driver" in found[2].mend


def test_missing_packages_are_named_with_their_extra() -> None:
    everything = check_packages(["gps-ingest"], rerun_wanted=True, has=lambda _: True)
    assert {check.mark for check in everything} == {Mark.FINE}
    nothing = by_subject(
        tuple(check_packages(["gps-ingest"], rerun_wanted=True, has=lambda _: False))
    )
    service = nothing["packages of gps-ingest"]
    assert service == wrong(
        "packages of gps-ingest",
        "google.transit, httpx2, pynmea2, serial missing",
        'pip install "wayline[gps-ingest]"',
    )
    assert nothing["package rerun"].mark is Mark.WRONG
    assert nothing["package asammdf"].mark is Mark.NOTE


@pytest.mark.parametrize(
    ("version", "enough"),
    [
        ("v20.19.0", True), ("v20.18.9", False), ("v21.19.0", False), ("v22.11.0", False),
        ("v22.12.0", True), ("v24.0.0", True), ("v18.20.0", False), ("", False), ("node", False),
    ],
)  # fmt: skip
def test_the_node_version_is_that_of_the_pages_tools(version: str, enough: bool) -> None:
    assert is_node_enough(version) is enough


def test_a_page_that_is_not_built_is_wrong(tmp_path: Path) -> None:
    index = tmp_path / "index.html"
    for node, mend in (("v22.12.0", "run scripts/setup"), (None, "install Node.js")):
        page, tools = check_page(index, node)
        assert page.mark is Mark.WRONG
        assert page.mend.startswith(mend)
        assert tools.mark is (Mark.FINE if node else Mark.NOTE)
    index.touch()
    assert is_well(check_page(index, None))


def test_node_is_found_only_where_it_is(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert node_version() is None
    node = tmp_path / "node"
    node.write_text("#!/bin/sh\necho v22.12.0\n")
    node.chmod(0o755)
    assert node_version() == "v22.12.0"


@pytest.mark.parametrize(
    ("free_bytes", "mark"),
    [(10**8, Mark.WRONG), (10**9, Mark.NOTE), (10**10, Mark.FINE)],
)
def test_a_full_disk_is_wrong(free_bytes: int, mark: Mark) -> None:
    assert check_disk(Path("/"), free_bytes).mark is mark


@pytest.mark.parametrize(
    ("year", "mark"), [(1970, Mark.WRONG), (2027, Mark.FINE), (2150, Mark.WRONG)]
)
def test_a_clock_that_cannot_be_right_is_wrong(year: int, mark: Mark) -> None:
    assert check_clock(dt.datetime(year, 5, 1, tzinfo=dt.UTC)).mark is mark


def test_the_disk_is_the_databases(tmp_path: Path) -> None:
    assert data_folder(f"sqlite:///{tmp_path}/a.db") == tmp_path
    assert data_folder("postgresql://localhost/a") == Path.cwd()
    assert data_folder(None) == Path.cwd()


def test_the_machine_of_these_tests_has_the_packages() -> None:
    subjects = by_subject(tuple(machine(None, ["gps-ingest"])))
    assert subjects["packages of gps-ingest"].mark is Mark.FINE
    assert "page" not in subjects
