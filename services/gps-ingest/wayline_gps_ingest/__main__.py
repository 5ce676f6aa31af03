"""The gps-ingest process: receivers and agencies' vehicles, or recordings, onto the bus."""

import os
from argparse import Namespace
from collections.abc import Callable, Sequence

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
from wayline_gps_ingest.agency_key import key_of
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.gpsd import GpsdCore
from wayline_gps_ingest.raw.live import RawReceiver
from wayline_gps_ingest.realtime_feed import RealtimeFeed
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
    """The service on the configured receivers and agencies. Raises InputError."""
    if settings.nmea or settings.raw:
        settings.own_vehicle()
    names = source_names(NAME)
    heard = [Receiver(next(names), nmea) for nmea in settings.nmea]
    agencies = [RealtimeFeed(next(names), avl, key_of(avl, os.environ)) for avl in settings.avl]
    measuring = [RawReceiver(next(names), raw) for raw in settings.raw]
    receivers: dict[str, Receiver] = {each.name: each for each in (*heard, *measuring)}
    raw_nodes = {each.name: each.node for each in measuring}

    def make_node(vehicle_id: str, source: str) -> Node:
        del vehicle_id
        if source in raw_nodes:
            return raw_nodes[source]
        latency_s = settings.vehicle.gps_latency_s
        if source not in receivers:
            return Node(source, GpsIngestCore(latency_s, clock_from_ns=EARLIEST_NS))
        receiver = receivers[source]
        kind = GpsdCore if receiver.is_gpsd else GpsIngestCore
        core = kind(latency_s, clock_from_ns=EARLIEST_NS)
        receiver.faults = lambda: core.faults
        return Node(source, core)

    feeds: Sequence[Receiver | RealtimeFeed] = [*heard, *agencies, *measuring]
    return Service(
        NAME,
        make_node,
        feeds=feeds,
        views=[FixNotes(receivers)],
        make_app=app_with_receivers(settings, receivers),
        bad_input=lambda: sum(sum(each.faults().values()) for each in feeds),
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
