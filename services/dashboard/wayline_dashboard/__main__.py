"""The dashboard process."""

import time
from argparse import Namespace
from collections.abc import Sequence
from typing import ClassVar

import msgspec

from wayline.messages import Message
from wayline.node import Node
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import load_routes
from wayline.shell import main as run_shell
from wayline.view import Receipt
from wayline_dashboard.app import create_dashboard
from wayline_dashboard.live_view import LiveView

NAME = "dashboard"


class NoCore:
    """Until a service may have none."""

    reads: ClassVar[frozenset[type[Message]]] = frozenset()
    period_ns: ClassVar[int | None] = None

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message]:
        """Nothing follows."""
        del message, source
        return []


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured: a view without a core."""
    del options
    routes = load_routes(settings)
    live = LiveView()

    def put(vehicle_id: str, message: Message, source: str) -> None:
        live.put(vehicle_id, message, source, Receipt(time.monotonic_ns()))

    return Service(
        NAME,
        lambda _vehicle_id, _source: Node(NAME, NoCore()),
        live.reads,
        watch=put,
        watch_alive=live.put_service,
        make_app=lambda healthz, telemetry: create_dashboard(
            live,
            settings.http_of(NAME),
            routes=routes,
            healthz=healthz,
            registry=telemetry.registry,
        ),
    )


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Shows vehicles live on a web page.", build)


if __name__ == "__main__":
    main()
