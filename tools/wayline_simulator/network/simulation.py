"""Pure: the days of a simulated network, bus after bus."""

import datetime as dt
from collections.abc import Iterator
from typing import NamedTuple

from wayline_simulator.network.model import NetworkModel, Part, randomness
from wayline_simulator.network.reports import Reports, Track, reports_of, track_of
from wayline_simulator.network.ride import Ride, drive_block
from wayline_simulator.network.schedule import SERVICES, PlannedTrip, make_schedule
from wayline_simulator.network.streets import Way, make_ways
from wayline_simulator.network.traffic import DayTraffic, is_weekday


class Network(NamedTuple):
    """The streets and the timetable."""

    ways: tuple[Way, ...]
    trips: tuple[PlannedTrip, ...]


class VehicleDay(NamedTuple):
    """A bus on one day; times are seconds after that day's midnight."""

    vehicle: int
    """From 1."""
    number: int
    """Of the day, from 1."""
    day: dt.date
    ride: Ride
    track: Track
    reports: Reports


def make_network(model: NetworkModel) -> Network:
    """The network, which is the same on all its days."""
    ways = make_ways(model)
    return Network(ways, make_schedule(model, ways))


def drive_days(model: NetworkModel, network: Network) -> Iterator[VehicleDay]:
    """Every bus on every day on which there is a block for it."""
    for number in range(1, model.days + 1):
        traffic = traffic_of(model, network, number)
        for vehicle in range(1, model.vehicles + 1):
            ride = ride_of(model, network, traffic, vehicle)
            if ride is not None:
                track = track_of(ride)
                random = randomness(model, Part.REPORTS, number, vehicle)
                reports = reports_of(track, model.every_s, random)
                yield VehicleDay(vehicle, number, traffic.day, ride, track, reports)


def traffic_of(model: NetworkModel, network: Network, number: int) -> DayTraffic:
    """The streets on one day; the first is 1."""
    day = model.start + dt.timedelta(days=number - 1)
    return DayTraffic(model, network.ways, day, number)


def ride_of(
    model: NetworkModel, network: Network, traffic: DayTraffic, vehicle: int
) -> Ride | None:
    """A bus's day; None where there is no block for it."""
    block_id = f"{SERVICES[0 if is_weekday(traffic.day) else 1]}-{vehicle}"
    trips = [trip for trip in network.trips if trip.block_id == block_id]
    if not trips:
        return None
    return drive_block(trips, traffic, randomness(model, Part.RIDE, traffic.number, vehicle))
