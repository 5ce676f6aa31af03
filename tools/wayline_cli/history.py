"""`wayline history`: what a history database holds, as lists and as files."""

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import BinaryIO, NamedTuple, TextIO

import msgspec
from rich.console import Console
from rich.table import Table

from wayline.database import open_database
from wayline.errors import InputError
from wayline.parameters import read_parameters
from wayline.query_error import QueryError
from wayline.rfc3339 import rfc3339
from wayline.trip_distance.wording import in_km
from wayline_history.answers import TripAnswer, TripList, trip_answer
from wayline_history.documents import document_of, stepped
from wayline_history.questions import StretchParameters, TrackParameters
from wayline_history.reading import HistoryReader

FORMS = ("gpx", "csv", "geojson", "json")
EVER = {"from": "1980-01-02", "to": "2099-12-31"}


class Asked(NamedTuple):
    """What the options say; None where they do not."""

    vehicle_id: str | None = None
    from_: str | None = None
    to: str | None = None
    kind: str | None = None
    step_s: float | None = None

    def parameters(self) -> dict[str, str]:
        """As HTTP takes them."""
        given = {"from": self.from_, "to": self.to, "kind": self.kind, "step_s": self.step_s}
        return {name: str(value) for name, value in given.items() if value is not None}


@contextmanager
def opened(database_url: str) -> Iterator[HistoryReader]:
    """The reader of a database that is there.

    Raises InputError for one that is not, and for a question that makes no sense.
    """
    engine = open_database(database_url, "wayline_history", create=False)
    try:
        yield HistoryReader(engine)
    except QueryError as error:
        option = "question" if error.parameter is None else f"--{error.parameter}"
        raise InputError(option.replace("_", "-"), error.detail, "correct it") from None
    finally:
        engine.dispose()


def list_vehicles(database_url: str, console: Console) -> None:
    """A row a vehicle: from when to when something is kept of it, by whole hours, and how much."""
    with opened(database_url) as reader:
        found = reader.vehicles()
    table = Table("vehicle", "from", "to", box=None, pad_edge=False)
    table.add_column("megabytes", justify="right")
    for each in found:
        first, last = (rfc3339(t_ns)[:16] + "Z" for t_ns in (each.first_ns, each.last_ns))
        table.add_row(each.vehicle_id, first, last, f"{each.bytes / 1e6:,.3f}")
    console.print(table)


def list_trips(database_url: str, asked: Asked, form: str, out: TextIO) -> None:
    """The trips of one vehicle, or of all, by vehicle and time: a table, CSV or JSON."""
    with opened(database_url) as reader:
        trips = tuple(_trips(reader, asked))
    if form == "json":
        out.write(msgspec.json.encode(TripList(trips)).decode() + "\n")
    elif form == "csv":
        names = [name for name in TripAnswer.__struct_fields__ if name != "stops"]
        out.write(",".join([*names, "stops"]) + "\n")
        for trip in trips:
            cells = [_cell(getattr(trip, name)) for name in names]
            out.write(",".join([*cells, str(len(trip.stops))]) + "\n")
    elif form == "table":
        _print_trips(trips, Console(file=out))
    else:
        raise InputError("--format", f"{form!r} is unknown", "give table, csv or json")


def _trips(reader: HistoryReader, asked: Asked) -> Iterator[TripAnswer]:
    stretch = read_parameters(EVER | asked.parameters(), StretchParameters).stretch(
        time.time_ns(), days_max=None
    )
    known = [each.vehicle_id for each in reader.vehicles()]
    for vehicle_id in (
        known if asked.vehicle_id is None else [known_vehicle(reader, asked.vehicle_id)]
    ):
        for kept in reader.trips(vehicle_id, *stretch):
            yield trip_answer(*kept)


def _print_trips(trips: tuple[TripAnswer, ...], console: Console) -> None:
    table = Table("trip", box=None, pad_edge=False)
    for name in ("km", "lasted", "moving", "climb", "stops"):
        table.add_column(name, justify="right")
    for trip in trips:
        table.add_row(
            trip.trip_key,
            in_km(trip.distance_m, trip.distance_std_m),
            f"{trip.seconds / 60.0:,.1f} min",
            f"{trip.moving_s / 60.0:,.1f} min",
            "" if trip.climb_m is None else f"{trip.climb_m:,.0f} m",
            str(len(trip.stops)),
        )
    console.print(table)


def _cell(value: object) -> str:
    return "" if value is None else str(value)


def export_track(
    database_url: str, asked: Asked, form: str, open_out: Callable[[], BinaryIO]
) -> int:
    """Write a vehicle's track to what `open_out` opens; returns the number of bytes.

    Raises InputError.
    """
    if form not in FORMS:
        raise InputError("--format", f"{form!r} is unknown", f"give {', '.join(FORMS)}")
    with opened(database_url) as reader:
        vehicle_id = known_vehicle(reader, asked.vehicle_id or _only(reader))
        question = read_parameters(EVER | asked.parameters(), TrackParameters)
        stretch = question.stretch(time.time_ns(), days_max=None)
        parts = document_of(
            form,  # type: ignore[arg-type]  # is one of FORMS
            vehicle_id,
            question.kind,
            stretch,
            lambda: stepped(reader.rows(vehicle_id, question.kind, *stretch), question.step_s),
        )
        with open_out() as file:
            return sum(file.write(part) for part in parts)


def vehicles_asked_for(reader: HistoryReader, asked: Asked) -> list[str]:
    """The one vehicle, else all of which something is kept. Raises InputError."""
    if asked.vehicle_id is not None:
        return [known_vehicle(reader, asked.vehicle_id)]
    return [each.vehicle_id for each in reader.vehicles()]


def known_vehicle(reader: HistoryReader, vehicle_id: str) -> str:
    """The vehicle, of which something is kept. Raises InputError."""
    if reader.is_known(vehicle_id):
        return vehicle_id
    known = ", ".join(each.vehicle_id for each in reader.vehicles()) or "of none"
    what = f"nothing is kept of {json.dumps(vehicle_id)}"
    raise InputError("--vehicle", what, f"name one of which something is: {known}")


def _only(reader: HistoryReader) -> str:
    vehicles = [each.vehicle_id for each in reader.vehicles()]
    if len(vehicles) == 1:
        return vehicles[0]
    what = "is missing, there is not one vehicle but several" if vehicles else "nothing is kept"
    raise InputError("--vehicle", what, f"name one of {', '.join(vehicles) or 'those to come'}")
