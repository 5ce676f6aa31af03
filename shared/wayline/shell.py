"""What every service's command does before and after its loop."""

import argparse
import gc
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from msgspec.structs import replace

from wayline import __version__
from wayline.bus import open_session
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.http import Healthz, create_service_app
from wayline.play_clock import PlayClock, agree
from wayline.playback import Playback, PlayOptions
from wayline.process import run
from wayline.received import Recording, begun
from wayline.route import Route
from wayline.route_file import load_route
from wayline.service import Service
from wayline.settings import Settings, load_settings, overridden
from wayline.telemetry import Telemetry

Build = Callable[[Settings, argparse.Namespace], Service]
OpenRecordings = Callable[[], Sequence[Recording]]
MakeApp = Callable[[Callable[[], Healthz], Telemetry], object]


def main(name: str, purpose: str, build: Build, *, plays: bool = False) -> None:
    """Run a service's command: `--config FILE`, and for ingest what plays a drive.

    Bad input is one line on stderr and status 2; SIGTERM and Ctrl-C end with 0.
    """
    parser = argparse.ArgumentParser(prog=f"wayline-{name}", description=purpose)
    parser.add_argument("--config", type=Path, metavar="FILE", help="configuration (TOML)")
    parser.add_argument("--version", action="version", version=__version__)
    if plays:
        _add_play_arguments(parser)
    options = parser.parse_args()
    try:
        settings = _settings(options, plays=plays)
        run(build(settings, options), settings)
    except InputError as error:
        sys.stderr.write(f"wayline-{name}: {error}\n")
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(0)
    finally:
        # at its end Python looks for cycles in all that it has loaded, again and again: on a busy
        # machine longer than a supervisor waits
        gc.freeze()


def _add_play_arguments(parser: argparse.ArgumentParser) -> None:
    play = parser.add_argument_group("playing a recorded drive instead of live sources")
    play.add_argument("--drive", type=Path, metavar="DRIVE", help="a drive's folder")
    play.add_argument("--speed", type=float, default=1.0, help="times as fast as driven")
    play.add_argument("--loop", action="store_true", help="begin again at the end")
    play.add_argument("--now", action="store_true", help="shift the drive's time to now")


def _settings(options: argparse.Namespace, *, plays: bool) -> Settings:
    """The configuration; a drive names its own vehicle and needs no file."""
    drive = options.drive if plays else None
    if plays and options.speed <= 0.0:
        raise InputError("--speed", f"{options.speed:g} is not positive", "give 1 or more")
    if options.config is None and drive is None:
        raise InputError("--config", "is missing", "give --config FILE (see deploy/wayline.toml)")
    settings = (
        load_settings(options.config) if options.config else overridden(Settings(), os.environ)
    )
    if drive is None:
        return settings
    vehicle_id = load_drive(drive).drive.vehicle_id
    return replace(settings, vehicle_id=vehicle_id, vehicles=())


def player(
    name: str, settings: Settings, options: argparse.Namespace, open_recordings: OpenRecordings
) -> Service:
    """A service that plays the recordings of `--drive`. Raises InputError."""
    played = playback(name, settings, options, open_recordings)
    return Service(
        name,
        feeds=[played],
        make_app=plain_app(name, settings),
        bad_input=lambda: played.bad_input,
        is_recorded=True,
    )


def playback(
    name: str, settings: Settings, options: argparse.Namespace, open_recordings: OpenRecordings
) -> Playback:
    """The feed that plays the recordings of `--drive`, in step with the other players.

    Raises InputError where nothing of them can be read; what is only partly so is said.
    """
    vehicle_id = settings.own_vehicle()
    for warning in begun(open_recordings()).warnings:
        sys.stderr.write(f"wayline-{name}: warning: {warning}\n")

    @contextmanager
    def agreed(own: PlayClock) -> Iterator[PlayClock]:
        """Later players ask as long as this one plays; an open session would keep the process."""
        with open_session(settings.bus) as session:
            clock, queryable = agree(session, vehicle_id, own)
            yield clock
            queryable.undeclare()

    play = PlayOptions(speed=options.speed, loop=options.loop, now=options.now)
    return Playback(name, open_recordings, play, agreed)


def plain_app(name: str, settings: Settings) -> MakeApp:
    """An app with nothing but health and metrics."""

    def make(healthz: Callable[[], Healthz], telemetry: Telemetry) -> object:
        http = settings.http_of(name)
        return create_service_app(name, http, healthz=healthz, registry=telemetry.registry)

    return make


def load_routes(settings: Settings) -> list[Route]:
    """The configured routes. Raises InputError."""
    return [load_route(Path(path)) for path in settings.routes]
