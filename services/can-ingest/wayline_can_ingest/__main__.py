"""The can-ingest process: CAN interfaces, or a drive's recordings, onto the bus."""

from argparse import Namespace
from collections.abc import Callable

from wayline.drive_file import load_drive
from wayline.host_clock import EARLIEST_NS
from wayline.http import Healthz
from wayline.node import Node
from wayline.received import source_names
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import main as run_shell
from wayline.shell import plain_app, player
from wayline.telemetry import Telemetry
from wayline_can_ingest.bus_metrics import BusCollector
from wayline_can_ingest.bus_reader import READ_ERRORS
from wayline_can_ingest.configured import load_mapping
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.frames import MALFORMED
from wayline_can_ingest.interfaces import Interface
from wayline_can_ingest.obd2_poll import REPLIES
from wayline_can_ingest.receiver_clock import ReceiverClock
from wayline_can_ingest.recorded import recordings
from wayline_can_ingest.utc import DriveClock
from wayline_can_ingest.wanted import Wanted

NAME = "can-ingest"
OBD2 = "obd2"
"""The profile whose values have to be asked for."""
BAD = (MALFORMED, READ_ERRORS)
"""Of a bus's faults those that are bad input; error and remote frames belong to a bus."""


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured."""
    if options.drive is not None:
        drive = load_drive(options.drive)
        where = str(options.drive)
        return player(NAME, settings, options, lambda: recordings(drive, where))
    return live(settings)


def live(settings: Settings) -> Service:
    """The service on the configured buses. Raises InputError."""
    settings.own_vehicle()
    vehicle = settings.vehicle
    cores: dict[str, CanIngestCore] = {}
    buses: dict[str, Interface] = {}
    host = ReceiverClock(buses.keys(), vehicle.gps_latency_s)
    for name, source in zip(source_names(NAME), settings.can, strict=False):
        mapping = load_mapping(source, vehicle, "configuration [[can]]")
        clock = DriveClock.of(source, doubts_start=True, clock_from_ns=EARLIEST_NS)
        cores[name] = CanIngestCore(source, mapping, vehicle, clock=clock)
        polls = OBD2 in vehicle.profiles if source.obd2 is None else source.obd2
        wanted = Wanted(mapping, REPLIES if polls else ())
        buses[name] = Interface(name, source, wanted, polls=polls, now_ns=host.now_ns)

    def bad_input() -> int:
        of_cores = sum(core.bad_input + core.dropped for core in cores.values())
        return of_cores + sum(bus.faults.get(kind, 0) for bus in buses.values() for kind in BAD)

    return Service(
        NAME,
        lambda _, source: Node(source, cores[source]),
        views=[host],
        feeds=list(buses.values()),
        make_app=app_with_buses(settings, buses),
        bad_input=bad_input,
    )


def app_with_buses(
    settings: Settings, buses: dict[str, Interface]
) -> Callable[[Callable[[], Healthz], Telemetry], object]:
    """Health and metrics, the buses' own among them."""
    make_plain = plain_app(NAME, settings)

    def make(healthz: Callable[[], Healthz], telemetry: Telemetry) -> object:
        telemetry.registry.register(
            BusCollector(lambda: [(each.name, each.condition) for each in buses.values()])
        )
        return make_plain(healthz, telemetry)

    return make


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Publishes a vehicle's sensors from its CAN buses.", build, plays=True)


if __name__ == "__main__":
    main()
