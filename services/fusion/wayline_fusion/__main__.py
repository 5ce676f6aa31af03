"""The fusion process."""

from argparse import Namespace

from wayline.database import open_database
from wayline.node import Node
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import main as run_shell
from wayline.shell import plain_app
from wayline_fusion.core import FusionCore
from wayline_fusion.keeping.patient_store import PatientStore
from wayline_fusion.keeping.store import FusionStore
from wayline_fusion.live_view import live_views

NAME = "fusion"


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured, with its live view where that is wanted."""
    del options
    url = settings.database_url
    engine = None if url is None else open_database(url, "wayline_fusion")

    def make_node(vehicle_id: str, source: str) -> Node:
        del source
        if engine is None:
            return Node(NAME, FusionCore(settings.tuning))
        store = PatientStore(FusionStore(engine, vehicle_id))
        return Node(NAME, FusionCore(settings.tuning, store.load()), store)

    return Service(
        NAME,
        make_node,
        FusionCore.reads,
        views=live_views(settings),
        make_app=plain_app(NAME, settings),
    )


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Filters fixes and vehicle sensors into a pose.", build)


if __name__ == "__main__":
    main()
