"""The can-ingest process: CAN interfaces, or a drive's recordings, onto the bus."""

from argparse import Namespace
from pathlib import Path

from wayline.arrival import source_names
from wayline.drive import load_drive
from wayline.node import Node
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import main as run_shell
from wayline.shell import plain_app, playback
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.dbc import load_databases
from wayline_can_ingest.interfaces import Interface
from wayline_can_ingest.mapping import compile_mapping
from wayline_can_ingest.recorded import recordings

NAME = "can-ingest"


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured."""
    app = plain_app(NAME, settings)
    if options.drive is not None:
        drive = load_drive(options.drive)
        where = str(options.drive)
        played = playback(NAME, settings, options, lambda: recordings(drive, where))
        return Service(NAME, feeds=[played], make_app=app, bad_input=lambda: played.bad_input)
    vehicle = settings.vehicle
    cores: dict[str, CanIngestCore] = {}
    feeds = []
    for name, source in zip(source_names(NAME), settings.can, strict=False):
        databases = load_databases([Path(path) for path in source.dbc])
        mapping = compile_mapping(source, databases, vehicle, "configuration [[can]]")
        cores[name] = CanIngestCore(source, mapping, vehicle)
        feeds.append(Interface(name, source))
    return Service(
        NAME,
        lambda _, source: Node(source, cores[source]),
        feeds=feeds,
        make_app=app,
        bad_input=lambda: sum(core.bad_input + core.dropped for core in cores.values()),
    )


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Publishes a vehicle's sensors from its CAN buses.", build, plays=True)


if __name__ == "__main__":
    main()
