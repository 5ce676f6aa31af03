"""The eta process."""

from argparse import Namespace

from wayline.keys import query_key
from wayline.node import Node
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import load_routes
from wayline.shell import main as run_shell
from wayline_eta.app import create_eta_app
from wayline_eta.board import EtaBoard, answer_arrivals
from wayline_eta.core import make_eta_core

NAME = "eta"


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured."""
    del options
    routes = load_routes(settings)
    board = EtaBoard()
    return Service(
        NAME,
        lambda *_: Node(NAME, make_eta_core(routes, settings.tuning)),
        make_eta_core(routes, settings.tuning).reads,
        views=[board],
        make_app=lambda healthz, telemetry: create_eta_app(
            board,
            routes,
            settings.http_of(NAME),
            healthz=healthz,
            registry=telemetry.registry,
        ),
        answers={
            query_key("*", "arrivals"): lambda vehicle_id, parameters: answer_arrivals(
                board, vehicle_id, parameters
            )
        },
    )


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Projects poses on routes and predicts arrivals.", build)


if __name__ == "__main__":
    main()
