"""The history process."""

from argparse import Namespace

from wayline.errors import InputError
from wayline.node import Node
from wayline.patient_store import PatientStore, Tables
from wayline.service import Service
from wayline.settings import Settings
from wayline.shell import main as run_shell
from wayline_history.app import create_history_app
from wayline_history.archive import Archive
from wayline_history.attendance_log import AttendanceLog
from wayline_history.core import HistoryCore
from wayline_history.housekeeping import Limits
from wayline_history.kept import HistoryTables, Openings, UnderWay
from wayline_history.losses import Losses

NAME = "history"
WAITING_MAX = 20_000
"""Pieces that wait for the database: more than six minutes of 500 vehicles, days of one."""


def build(settings: Settings, options: Namespace) -> Service:
    """The service as configured."""
    del options
    if settings.database_url is None:
        mend = "set database_url or WAYLINE_DATABASE_URL, e.g. sqlite:///history.db"
        raise InputError("configuration", "history has no database", mend)
    losses, openings = Losses(), Openings()
    limits = Limits(
        settings.history_days, settings.history_max_mb, settings.history_thin_after_h * 3600.0
    )
    where = Tables(
        settings.database_url,
        "wayline_history",
        lambda engine: HistoryTables(engine, limits, losses, openings),
    )
    store = PatientStore(where, settings, capacity=WAITING_MAX, on_lost=losses.note)

    def make_node(vehicle_id: str, source: str) -> Node:
        del source
        trip = store.ask(lambda kept: kept.under_way(vehicle_id)) or UnderWay()
        core = HistoryCore(
            vehicle_id, known=trip.rows, fixes=trip.fixes, refused_ns=trip.refused_ns
        )
        return Node(NAME, core, store.of(vehicle_id))

    archive = Archive(settings.database_url)
    return Service(
        NAME,
        make_node,
        HistoryCore.reads,
        watch_alive=AttendanceLog(store.put).note,
        store=store,
        make_app=lambda healthz, telemetry: create_history_app(
            archive, settings.http_of(NAME), healthz=healthz, registry=telemetry.registry
        ),
    )


def main() -> None:
    """Run the command."""
    run_shell(NAME, "Keeps what happened, and answers about it.", build)


if __name__ == "__main__":
    main()
