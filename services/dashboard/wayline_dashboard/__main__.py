"""The dashboard process."""

from argparse import Namespace

from wayline.service import Service
from wayline.services import SERVICES
from wayline.settings import Settings
from wayline.shell import load_routes
from wayline.shell import main as run_shell
from wayline_dashboard.app import create_dashboard
from wayline_dashboard.live_view import LiveView

NAME = "dashboard"


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured: a view, and no core."""
    del options
    routes = load_routes(settings)
    live = LiveView()
    return Service(
        NAME,
        views=[live],
        watch_alive=live.put_service,
        make_app=lambda healthz, telemetry: create_dashboard(
            live,
            settings.http_of(NAME),
            routes=routes,
            healthz=healthz,
            registry=telemetry.registry,
            history_url=settings.history_url or f"http://127.0.0.1:{history_port(settings)}",
        ),
    )


def history_port(settings: Settings) -> int:
    """Where history listens on the same machine."""
    return settings.ports.get("history", SERVICES["history"].port)


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Shows vehicles live on a web page.", build)


if __name__ == "__main__":
    main()
