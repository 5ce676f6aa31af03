"""The gps-ingest process: receivers, or a drive's recordings, onto the bus."""

from argparse import Namespace

from wayline.arrival import source_names
from wayline.drive import load_drive
from wayline.node import Node
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import main as run_shell
from wayline.shell import plain_app, playback
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.receivers import Receiver
from wayline_gps_ingest.recorded import recordings

NAME = "gps-ingest"


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured."""
    app = plain_app(NAME, settings)
    if options.drive is not None:
        drive = load_drive(options.drive)
        played = playback(NAME, settings, options, lambda: recordings(drive))
        return Service(NAME, feeds=[played], make_app=app, bad_input=lambda: played.bad_input)
    cores: list[GpsIngestCore] = []

    def make_node(vehicle_id: str, source: str) -> Node:
        del vehicle_id
        cores.append(GpsIngestCore(settings.vehicle.gps_latency_s))
        return Node(source, cores[-1])

    receivers = [
        Receiver(name, nmea) for name, nmea in zip(source_names(NAME), settings.nmea, strict=False)
    ]
    return Service(
        NAME,
        make_node,
        feeds=receivers,
        make_app=app,
        bad_input=lambda: sum(core.bad_input for core in cores),
    )


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Publishes what positioning receivers say.", build, plays=True)


if __name__ == "__main__":
    main()
