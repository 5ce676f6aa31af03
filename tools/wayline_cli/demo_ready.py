"""Waits until everything of the demo answers and every vehicle is on the page."""

import http.client
from collections.abc import Iterator, Mapping

import msgspec

from wayline.ending import Ending
from wayline_cli.demo_files import LOOPBACK, Demo

POLL_S = 0.3
TIMEOUT_S = 2.0
PATIENCE_S = 15.0
"""After so long it is said what is still missing."""


class SeenPose(msgspec.Struct):
    """What of a pose on the page tells that the vehicle is on the map."""

    lat_deg: float | None = None


class SeenVehicle(msgspec.Struct):
    """A vehicle of /v1/view."""

    vehicle_id: str
    pose: SeenPose | None = None


class SeenFleet(msgspec.Struct):
    """The part of /v1/view that is looked at."""

    vehicles: tuple[SeenVehicle, ...] = ()


def answer(port: int, path: str, timeout_s: float = TIMEOUT_S) -> tuple[int, bytes] | None:
    """Status and body of a GET on this machine; None where nothing answers."""
    connection = http.client.HTTPConnection(LOOPBACK, port, timeout=timeout_s)
    try:
        connection.request("GET", path)
        response = connection.getresponse()
        return response.status, response.read()
    except (OSError, http.client.HTTPException):
        return None
    finally:
        connection.close()


def missing(demo: Demo) -> list[str]:
    """What does not answer yet, else the vehicles that are not on the page yet."""
    silent = [name for name, port in demo.ports.http.items() if not is_alive(port)]
    return silent or sorted(demo.vehicles - placed_vehicles(demo.ports.http))


def is_alive(port: int) -> bool:
    """Whether a service answers that it turns; what it is to hear is asked of the page."""
    found = answer(port, "/livez")
    return found is not None and found[0] == http.client.OK


def placed_vehicles(http_ports: Mapping[str, int]) -> set[str]:
    """Vehicles whose pose has a position on the page."""
    found = answer(http_ports["dashboard"], "/v1/view")
    if found is None or found[0] != http.client.OK:
        return set()
    fleet = msgspec.json.decode(found[1], type=SeenFleet)
    return {
        vehicle.vehicle_id
        for vehicle in fleet.vehicles
        if vehicle.pose is not None and vehicle.pose.lat_deg is not None
    }


def await_live(demo: Demo, ending: Ending) -> Iterator[list[str]]:
    """What is missing, each time that the patience is over; ends when nothing is or when stopped.

    Whoever reads it asks `ending` which of the two it was.
    """
    waited_s = 0.0
    while not ending.requested:
        absent = missing(demo)
        if not absent:
            return
        if waited_s >= PATIENCE_S:
            waited_s = 0.0
            yield absent
        ending.wait(POLL_S)
        waited_s += POLL_S
