"""A small good feed, and every fault that agencies' feeds are known to have, to be put into it."""

import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

Tables = dict[str, str]

LAT_DEG, LON_DEG, STEP_DEG = 48.1, 11.5, 0.009
"""A stop every 1,000.7 m to the north."""
POINTS = [(LAT_DEG + 0.0009 * at, LON_DEG) for at in range(41)]


def good_feed() -> Tables:
    """Five stops, two minutes a leg, 480 s a trip: T and then U of one block on weekdays."""
    stops = "".join(f"S{at},Stop {at},{LAT_DEG + STEP_DEG * at:.6f},{LON_DEG}\n" for at in range(5))
    times = "".join(
        f"{trip},{hour}:{2 * at:02d}:00,{hour}:{2 * at:02d}:00,S{at},{at + 1}\n"
        for trip, hour in (("T", "08"), ("U", "09"))
        for at in range(5)
    )
    shape = "".join(f"SH,{lat:.6f},{lon},{at}\n" for at, (lat, lon) in enumerate(POINTS))
    return {
        "agency.txt": "agency_id,agency_name,agency_url,agency_timezone\n"
        "A,A,http://a.example,Europe/Berlin\n",
        "calendar.txt": "service_id,monday,tuesday,wednesday,thursday,friday,saturday,sunday,"
        "start_date,end_date\nS,1,1,1,1,1,0,0,20260101,20261231\n",
        "routes.txt": "route_id,agency_id,route_short_name,route_type\nR,A,1,3\n",
        "trips.txt": "route_id,service_id,trip_id,direction_id,block_id,shape_id\n"
        "R,S,T,0,B,SH\nR,S,U,0,B,SH\n",
        "stops.txt": "stop_id,stop_name,stop_lat,stop_lon\n" + stops,
        "shapes.txt": "shape_id,shape_pt_lat,shape_pt_lon,shape_pt_sequence\n" + shape,
        "stop_times.txt": "trip_id,arrival_time,departure_time,stop_id,stop_sequence\n" + times,
    }


class Fault(NamedTuple):
    """Something wrong in a feed."""

    name: str
    put: Callable[[Tables], None]
    """Changes the tables."""
    says: str
    """What the notes say of it; empty where it is mended without a word."""
    planned_s: float = 480.0
    """Of trip T afterwards, travel and waits before the last stop."""


def write_folder(tables: Tables, folder: Path, encoding: str = "utf-8") -> Path:
    """The tables as files of a folder."""
    for name, text in tables.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode(encoding))
    return folder


def write_zip(tables: Tables, path: Path) -> Path:
    """The tables as members of a zip file."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in tables.items():
            archive.writestr(name, text)
    return path


def named(tables: Tables, plain: str) -> str:
    """A table's name as earlier faults have left it."""
    return next(name for name in tables if name.lower().endswith(plain))


def edited(plain: str, *changes: tuple[str, str]) -> Callable[[Tables], None]:
    """A fault that exchanges texts of one table."""

    def put(tables: Tables) -> None:
        name = named(tables, plain)
        for before, after in changes:
            tables[name] = tables[name].replace(before, after)

    return put


def everywhere(change: Callable[[str], str]) -> Callable[[Tables], None]:
    """A fault of all tables."""

    def put(tables: Tables) -> None:
        for name in tables:
            tables[name] = change(tables[name])

    return put


def renamed(change: Callable[[str], str]) -> Callable[[Tables], None]:
    """A fault of all names of files."""

    def put(tables: Tables) -> None:
        for name in list(tables):
            tables[change(name)] = tables.pop(name)

    return put


def without(*plain: str) -> Callable[[Tables], None]:
    """Tables that are not there."""

    def put(tables: Tables) -> None:
        for name in plain:
            del tables[named(tables, name)]

    return put


def doubled(plain: str, begins: str) -> Callable[[Tables], None]:
    """Rows that are there twice."""

    def put(tables: Tables) -> None:
        name = named(tables, plain)
        rows = tables[name].splitlines(keepends=True)
        tables[name] += "".join(row for row in rows if row.lstrip("\ufeff ").startswith(begins))

    return put


def padded(text: str) -> str:
    """Blanks after every comma."""
    return text.replace(",", ", ")


def trailing(text: str) -> str:
    """Blanks before every comma."""
    return text.replace(",", " ,")


FAULTS = (
    Fault("quoted", edited("stops.txt", ("Stop 1", '"Mill ""A"", East"')), ""),
    Fault("no_shape", without("shapes.txt"), "names a shape_id without a line"),
    Fault("far", edited("stops.txt", ("S3,Stop 3,48.127000,11.5", "S3,Stop 3,48.127,11.511")),
          "a stop far from its shape"),
    Fault("swapped", edited("stop_times.txt", ("S1,2", "S9,2"), ("S2,3", "S1,3"), ("S9,2", "S2,2")),
          "two neighbouring stops in the wrong order"),
    Fault("no_calendar", without("calendar.txt"), "names a service_id without days"),
    Fault("no_routes", without("routes.txt"), "lacks a route_id"),
    Fault("no_agency", without("agency.txt"), "no agency_timezone that is known"),
    Fault("untimed", edited("stop_times.txt", ("08:06:00,08:06:00,", ",,")), ""),
    Fault("fast", edited("stop_times.txt", ("08:02:00,08:02:00", "08:00:05,08:00:05")),
          "need more than 40 m/s"),
    Fault("back", edited("stop_times.txt", ("08:06:00,08:06:00,S3", "07:00:00,07:00:00,S3")),
          "times that fall"),
    Fault("slow", edited("stop_times.txt", ("08:08:00,08:08:00", "08:38:00,08:38:00")),
          "slower than 1 m/s", 2280.0),
    Fault("no_time", edited("stop_times.txt", ("08:04:00,08:04:00", "soon,soon")), "is no time"),
    Fault("doubled", doubled("stop_times.txt", "T"), "are there twice"),
    Fault("trip_doubled", doubled("trips.txt", "R"), "trip_id is there twice"),
    Fault("no_order", edited("stop_times.txt", ("S4,5", "S4,last")), "in the order of the rows"),
    Fault("no_stop", edited("stops.txt", ("S1,Stop 1", "X1,Stop 1"), ("S1,", "X1,")),
          "has no place in stops.txt"),
    Fault("nowhere", edited("stops.txt", (f"S0,Stop 0,{LAT_DEG:.6f},{LON_DEG}", "S0,Stop 0,,"),
                            ("S4,", "S4,")),
          "stop_lat and stop_lon are no place", 360.0),
    Fault("padded", everywhere(padded), ""),
    Fault("trailing", everywhere(trailing), ""),
    Fault("marked", everywhere(lambda text: "\ufeff" + text), ""),
    Fault("windows", everywhere(lambda text: text.replace("\n", "\r\n")), ""),
    Fault("folder", renamed(lambda name: "feed/" + name), ""),
    Fault("capitals", renamed(str.upper), ""),
)  # fmt: skip
"""In the order in which they can be put in: texts first, then what all tables have."""
