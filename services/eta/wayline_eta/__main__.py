"""The eta process."""

import datetime as dt
import sys
from argparse import Namespace
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from fastapi import FastAPI

from wayline.database import DatabaseAwayError
from wayline.host_clock import told_ns
from wayline.http import Healthz
from wayline.keys import query_key
from wayline.node import Node
from wayline.patient_store import PatientStore, Tables
from wayline.route import Route
from wayline.seats import MakeNode
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import load_routes
from wayline.shell import main as run_shell
from wayline.telemetry import Telemetry
from wayline.timetable.loading import load_timetable, timetable_warnings
from wayline.timetable.model import Timetable
from wayline.timetable.runs import Runs
from wayline.timetable.versions import ended_line
from wayline_eta.accuracy import Accuracy
from wayline_eta.accuracy_metrics import AccuracyCollector
from wayline_eta.app import create_eta_app
from wayline_eta.board import EtaBoard, answer_arrivals
from wayline_eta.core import assigned_routes, eta_node
from wayline_eta.lessons import Lessons, lessons_by
from wayline_eta.sightings import LeftOut
from wayline_eta.store import EtaTables
from wayline_eta.timetable_core import timetable_node

NAME = "eta"
WAITING_MAX = 10_000
"""Records: every vehicle's scores come on the minute."""


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured."""
    del options
    routes = load_routes(settings)
    timetables = _timetables(settings)
    accuracy = Accuracy()
    lessons = lessons_by(timetables, accuracy.take)
    store = None
    if settings.database_url is not None:
        where = Tables(settings.database_url, "wayline_eta", partial(EtaTables, zone=lessons.zone))
        store = PatientStore(where, settings, lessons.remember, capacity=WAITING_MAX)
    left_out = LeftOut()
    make_node = _make_node(settings, routes, timetables, lessons, store, left_out=left_out)
    board = EtaBoard()

    def make_app(healthz: Callable[[], Healthz], telemetry: Telemetry) -> FastAPI:
        telemetry.registry.register(AccuracyCollector(accuracy))
        return create_eta_app(
            board,
            routes,
            settings.http_of(NAME),
            timetables=timetables,
            accuracy=accuracy,
            healthz=healthz,
            registry=telemetry.registry,
        )

    return Service(
        NAME,
        make_node,
        make_node("", "").core.reads,
        views=[board],
        store=store,
        make_app=make_app,
        answers={
            query_key("*", "arrivals"): lambda vehicle_id, parameters: answer_arrivals(
                board, vehicle_id, parameters
            )
        },
        bad_input=lambda: left_out.count,
        notice=lambda: ended_line(timetables, _today()),
    )


def _timetables(settings: Settings) -> list[Timetable]:
    """The configured ones, with what a user should know of them said."""
    timetables = [_loaded(Path(feed), settings.database_url) for feed in settings.feeds]
    names = [each.name for each in settings.assignment] if timetables else []
    ended = ended_line(timetables, _today())
    for warning in (*timetable_warnings(timetables, names), *([ended] if ended else ())):
        sys.stderr.write(f"wayline-{NAME}: warning: {warning}\n")
    return timetables


def _make_node(
    settings: Settings,
    routes: Sequence[Route],
    timetables: Sequence[Timetable],
    lessons: Lessons,
    store: PatientStore[EtaTables] | None,
    *,
    left_out: LeftOut,
) -> MakeNode:
    """Cores on the configured timetables, of vehicles that no route is assigned to, or routes."""
    tuning = settings.tuning
    named = {each.vehicle_id: each.route_id for each in settings.assignment}
    assigned = {each.vehicle_id: each.name for each in settings.assignment}
    of_routes = {route.route_id for route in routes}
    runs = Runs(timetables)

    def make(vehicle_id: str, source: str) -> Node:
        del source
        route_id = named.get(vehicle_id)
        kept = None if store is None else store.of(vehicle_id)
        if not timetables or route_id in of_routes:
            on = assigned_routes(routes, route_id)
            return eta_node(on, tuning, lessons, kept, left_out=left_out)
        name = assigned.get(vehicle_id)
        return timetable_node(runs, tuning, name, lessons, kept, left_out=left_out)

    return make


def _today() -> dt.date:
    """By the host's clock."""
    return dt.datetime.fromtimestamp(told_ns() * 1e-9, dt.UTC).date()


def _loaded(feed: Path, database_url: str | None) -> Timetable:
    """A timetable; from its feed where the database that may have kept it is away."""
    try:
        return load_timetable(feed, database_url)
    except DatabaseAwayError as error:
        sys.stderr.write(f"wayline-{NAME}: warning: {error}; {feed} is read anew\n")
        return load_timetable(feed, None)


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Projects poses on routes and predicts arrivals.", build)


if __name__ == "__main__":
    main()
