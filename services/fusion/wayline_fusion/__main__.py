"""The fusion process."""

from argparse import Namespace

from wayline.node import Node
from wayline.patient_store import PatientStore, Tables
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import main as run_shell
from wayline.shell import plain_app
from wayline_fusion.core import FusionCore
from wayline_fusion.keeping.store import FusionTables
from wayline_fusion.live_view import live_views

NAME = "fusion"


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured, with its live view where that is wanted."""
    del options
    store, told = None, set[str]()
    if settings.database_url is not None:
        where = Tables(
            settings.database_url, "wayline_fusion", lambda engine: FusionTables(engine, told)
        )
        store = PatientStore(where, settings, newest_only=True)

    def make_node(vehicle_id: str, source: str) -> Node:
        del source
        if store is None:
            return Node(NAME, FusionCore(settings.tuning, vehicle=settings.vehicle))
        found = store.ask(lambda tables: tables.load(vehicle_id))
        if found is None:
            return Node(
                NAME, FusionCore(settings.tuning, vehicle=settings.vehicle), store.of(vehicle_id)
            )
        told.add(vehicle_id)
        core = FusionCore(settings.tuning, found.saved, settings.vehicle)
        return Node(NAME, core, store.of(vehicle_id))

    return Service(
        NAME,
        make_node,
        FusionCore.reads,
        views=live_views(settings),
        make_app=plain_app(NAME, settings),
        store=store,
    )


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Filters fixes and vehicle sensors into a pose.", build)


if __name__ == "__main__":
    main()
