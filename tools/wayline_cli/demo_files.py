"""What the demo runs on: its ports, its configuration files, its drives, its processes."""

import socket
import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import msgspec

from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.route_file import load_route
from wayline.services import SERVICES
from wayline_cli.up import Child, service_command
from wayline_simulator.drive_folder import simulate
from wayline_simulator.scenario_file import load_scenario

LOOPBACK = "127.0.0.1"
ROUTER_PORT, RERUN_PORT = 7447, 9876
TRUCK_GPS = "gps-ingest-2"
"""The truck's; the first is the shuttle's."""
SHUTTLE_ID = "target-shuttle"
TRUCK_ID = "hill-truck"
SHUTTLE_FOLDERS = (
    Path(__file__).with_name("avl-shuttle"),
    Path(__file__).parents[2] / "deploy" / "demo" / "avl-shuttle",
)
"""In the wheel, in a checkout."""
VEHICLES = (SHUTTLE_ID, TRUCK_ID)
PORT_COUNT = len(SERVICES) + 3


class Ports(NamedTuple):
    """Where everything listens."""

    http: dict[str, int]
    """By process."""
    router: int
    rerun: int

    def all(self) -> dict[str, int]:
        """Every port by what listens there."""
        return {**self.http, "router": self.router, "rerun": self.rerun}


@dataclass(frozen=True, slots=True)
class Demo:
    """A demo that is ready to start."""

    ports: Ports
    stages: list[list[Child]]
    vehicles: frozenset[str]
    has_rerun: bool


def choose_ports(first: int | None) -> Ports:
    """The services' own ports, or PORT_COUNT in a row. Raises InputError where there are none."""
    own = {row.name: row.port for row in sorted(SERVICES.values(), key=lambda row: row.port)}
    if first is None:
        return Ports({**own, TRUCK_GPS: max(own.values()) + 1}, ROUTER_PORT, RERUN_PORT)
    highest = 65_536 - PORT_COUNT
    if not 1024 <= first <= highest:
        mend = f"give one from 1024 to {highest}, {PORT_COUNT} in a row are used"
        raise InputError("--first-port", f"{first} is no port to begin at", mend)
    of_processes = {name: first + place for place, name in enumerate((*own, TRUCK_GPS))}
    router = first + len(of_processes)
    return Ports(of_processes, router, router + 1)


def check_ports(ports: Ports) -> None:
    """Raise InputError naming the first port that is taken."""
    for name, port in ports.all().items():
        if not is_free(port):
            raise InputError(
                f"port {port} ({name})",
                "something listens there already",
                "stop it (another demo?) or give --first-port, e.g. --first-port 18000",
            )


def is_free(port: int, host: str = LOOPBACK) -> bool:
    """Whether a service could listen there."""
    try:
        with socket.create_server((host, port)):
            return True
    except OSError:
        return False


def find_shuttle() -> Path:
    """The folder of the recorded shuttle's drive. Raises InputError where it is not installed."""
    for folder in SHUTTLE_FOLDERS:
        if (folder / "drive.toml").is_file():
            return folder
    raise InputError(
        str(SHUTTLE_FOLDERS[-1]), "the shuttle's drive is not there", "run scripts/demo in a clone"
    )


def prepare(folder: Path, ports: Ports) -> Demo:
    """Write the simulated truck's drive and the configuration files. Raises InputError."""
    shuttle, truck = find_shuttle(), folder / "demo-truck"
    simulate(load_scenario("demo-truck"), truck)
    has_rerun = find_spec("rerun") is not None
    routes = [str(shuttle / "route.geojson"), str(truck / "route.geojson")]
    of_all = _configuration(folder, ports, ports.http, routes, has_rerun=has_rerun)
    # the shuttle runs by a timetable, on which its lap is late; the truck has its route
    feeds = f"feeds = {_toml([str(shuttle / 'feed')])}\n"
    of_all = feeds + of_all + _assigned(truck) + _build(truck)
    # with one route, its line is the road, and a lap is learned as soon as it ends
    of_slopes = _configuration(folder, ports, ports.http, routes[1:], has_rerun=False)
    truck_ports = ports.http | {"gps-ingest": ports.http[TRUCK_GPS]}
    of_truck = _configuration(folder, ports, truck_ports, [], has_rerun=False)
    config = _written(folder / "wayline.toml", of_all)
    slope_config = _written(folder / "slope-map.toml", of_slopes + _build(truck))
    truck_config = _written(folder / "demo-truck.toml", of_truck)
    own_configs = {"slope-map": slope_config}
    services = [
        *(
            Child(name, service_command(name, own_configs.get(name, config)))
            for name, row in SERVICES.items()
            if not row.reads_sensors
        ),
        Child("gps-ingest", _player("gps-ingest", config, shuttle)),
        Child(TRUCK_GPS, _player("gps-ingest", truck_config, truck)),
        Child("can-ingest", _player("can-ingest", truck_config, truck)),
    ]
    router = (sys.executable, "-m", "wayline.router", "--config", str(config))
    stages = [[Child("router", router)], services]
    return Demo(ports, stages, frozenset(VEHICLES), has_rerun)


def _player(service: str, config: Path, drive: Path) -> tuple[str, ...]:
    return (*service_command(service, config), "--drive", str(drive), "--loop", "--now")


def _configuration(
    folder: Path, ports: Ports, http: dict[str, int], routes: list[str], *, has_rerun: bool
) -> str:
    """A configuration file's text."""
    database_url = f"sqlite:///{folder / 'wayline.db'}"
    own_ports = (f"{name} = {port}" for name, port in http.items() if name in SERVICES)
    lines = (
        "# written by wayline demo",
        'vehicles = ["*"]',
        f"database_url = {_toml(database_url)}",
        f"routes = {_toml(routes)}",
        "[bus]",
        f"connect = {_toml([f'tcp/{LOOPBACK}:{ports.router}'])}",
        "[ports]",
        *own_ports,
        "[rerun]",
        f"enabled = {_toml(has_rerun)}",
        f"port = {ports.rerun}",
    )
    return "\n".join((*lines, ""))


def _assigned(drive: Path) -> str:
    """What says that the truck follows the route of its drive."""
    route = load_route(drive / "route.geojson")
    lines = (
        "[[assignment]]",
        f"vehicle_id = {_toml(TRUCK_ID)}",
        f"route_id = {_toml(route.route_id)}",
    )
    return "\n".join((*lines, ""))


def _build(drive: Path) -> str:
    """What the truck weighs and how the air holds it back; the shuttle tells no torque."""
    vehicle = msgspec.to_builtins(load_drive(drive).vehicle)
    known = (f"{name} = {_toml(value)}" for name, value in vehicle.items() if value is not None)
    return "\n".join(("[vehicle]", *known, ""))


def _toml(value: object) -> str:
    """JSON's strings and lists are TOML's too."""
    return msgspec.json.encode(value).decode()


def _written(path: Path, text: str) -> Path:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(str(path), reason, "name a folder that can be written") from None
    return path
