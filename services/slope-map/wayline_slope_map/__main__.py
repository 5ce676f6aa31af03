"""The slope-map process."""

from argparse import Namespace

import msgspec

from wayline.errors import InputError
from wayline.keys import FLEET, query_key
from wayline.node import Node
from wayline.patient_store import PatientStore, Tables
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import load_routes
from wayline.shell import main as run_shell
from wayline_slope_map.app import create_slope_app
from wayline_slope_map.book import SlopeBook
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.drives import Kept
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.matching import RoadIndex
from wayline_slope_map.queries import answer_lookahead
from wayline_slope_map.records import RoadLearned
from wayline_slope_map.smoothing_worker import SmoothingWorker
from wayline_slope_map.store import SlopeTables
from wayline_slope_map.tally import Tally
from wayline_slope_map.teaching import Teaching

NAME = "slope-map"


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured."""
    del options
    if settings.database_url is None:
        mend = "set database_url or WAYLINE_DATABASE_URL, e.g. sqlite:///slope.db"
        raise InputError("configuration", "slope-map has no database", mend)
    routes = load_routes(settings)
    index = RoadIndex()
    book, roads = SlopeBook(index=index), KnownRoads(index=index)

    def learn(learned: msgspec.Struct) -> None:
        if isinstance(learned, RoadLearned):
            roads.learn(learned.profile)
            book.learn(learned.profile)

    tally = Tally()
    where = Tables(
        settings.database_url, "wayline_slope_map", lambda engine: SlopeTables(engine, tally)
    )
    tables = PatientStore(where, settings, learn)
    store = SmoothingWorker(tables)
    store.hand_over()
    for route in routes:
        roads.follow(route.line, route.route_id, loop=route.loop, bin_m=settings.tuning.map_bin_m)
    assigned = {each.vehicle_id: each.route_id for each in settings.assignment}

    def make_node(vehicle_id: str, source: str) -> Node:
        del source
        route_id = assigned.get(vehicle_id)
        core = SlopeMapCore(roads, settings.tuning, vehicle_id, settings.vehicle, route_id)
        return Node(NAME, core, Teaching(store, roads))

    def drives(vehicle_id: str, limit: int) -> Kept | None:
        return tables.ask(lambda kept: kept.of_vehicle(vehicle_id, limit))

    return Service(
        NAME,
        make_node,
        SlopeMapCore.reads,
        views=[book],
        store=store,
        notice=tally.notice,
        make_app=lambda healthz, telemetry: create_slope_app(
            book,
            settings.http_of(NAME),
            drives=drives,
            healthz=healthz,
            registry=telemetry.registry,
        ),
        answers={
            query_key(FLEET, "lookahead"): lambda _, parameters: answer_lookahead(book, parameters)
        },
    )


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Learns the slope of roads and looks ahead.", build)


if __name__ == "__main__":
    main()
