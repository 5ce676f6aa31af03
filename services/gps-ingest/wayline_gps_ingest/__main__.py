"""The gps-ingest process: receivers, or a drive's recordings, onto the bus."""

from argparse import Namespace
from collections.abc import Callable

from wayline.drive_file import load_drive
from wayline.http import Healthz
from wayline.node import Node
from wayline.received import source_names
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import main as run_shell
from wayline.shell import plain_app, player
from wayline.telemetry import Telemetry
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.gpsd import GpsdCore
from wayline_gps_ingest.receiver_metrics import ReceiverCollector
from wayline_gps_ingest.receivers import FixNotes, Receiver
from wayline_gps_ingest.recorded import recordings

NAME = "gps-ingest"


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured."""
    if options.drive is not None:
        drive = load_drive(options.drive)
        where = str(options.drive)
        return player(NAME, settings, options, lambda: recordings(drive, where))
    return live(settings)


def live(settings: Settings) -> Service:
    """The service on the configured receivers. Raises InputError."""
    receivers = {
        name: Receiver(name, nmea)
        for name, nmea in zip(source_names(NAME), settings.nmea, strict=False)
    }

    def make_node(vehicle_id: str, source: str) -> Node:
        del vehicle_id
        receiver, latency_s = receivers[source], settings.vehicle.gps_latency_s
        core = GpsdCore(latency_s) if receiver.is_gpsd else GpsIngestCore(latency_s)
        receiver.faults = lambda: core.faults
        return Node(source, core)

    return Service(
        NAME,
        make_node,
        feeds=list(receivers.values()),
        views=[FixNotes(receivers)],
        make_app=app_with_receivers(settings, receivers),
        bad_input=lambda: sum(sum(each.faults().values()) for each in receivers.values()),
    )


def app_with_receivers(
    settings: Settings, receivers: dict[str, Receiver]
) -> Callable[[Callable[[], Healthz], Telemetry], object]:
    """Health and metrics, the receivers' own among them."""
    make_plain = plain_app(NAME, settings)

    def make(healthz: Callable[[], Healthz], telemetry: Telemetry) -> object:
        telemetry.registry.register(
            ReceiverCollector(lambda: [(each.name, each.condition) for each in receivers.values()])
        )
        return make_plain(healthz, telemetry)

    return make


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Publishes what positioning receivers say.", build, plays=True)


if __name__ == "__main__":
    main()
