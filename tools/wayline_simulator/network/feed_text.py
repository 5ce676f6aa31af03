"""Pure: the timetable of a simulated network as the tables of a GTFS feed."""

import datetime as dt
from collections.abc import Iterable, Sequence

from wayline_simulator.network.model import LINES, ZONE, NetworkModel
from wayline_simulator.network.schedule import SERVICES, PlannedTrip
from wayline_simulator.network.streets import Way

BEFORE, AFTER = dt.timedelta(days=30), dt.timedelta(days=60)
"""Of the calendar around the days that are driven."""
BUS = 3


def feed_tables(
    model: NetworkModel, ways: Sequence[Way], trips: Sequence[PlannedTrip]
) -> dict[str, str]:
    """The text of each file by its name."""
    return {
        "agency.txt": _table(
            "agency_id,agency_name,agency_url,agency_timezone",
            [("net", "Simulated network", "https://example.com", ZONE)],
        ),
        "routes.txt": _table(
            "route_id,agency_id,route_short_name,route_long_name,route_type",
            [(line, "net", line, f"Line {line}", BUS) for line in LINES],
        ),
        "calendar.txt": _calendar(model),
        "stops.txt": _stops(ways),
        "shapes.txt": _shapes(ways),
        "trips.txt": _table(
            "route_id,service_id,trip_id,trip_headsign,direction_id,block_id,shape_id",
            [
                (
                    trip.way.line_id, trip.service_id, trip.trip_id, trip.way.stops[-1].name,
                    trip.way.direction_id, trip.block_id, trip.way.way_id,
                )
                for trip in trips
            ],
        ),
        "stop_times.txt": _stop_times(trips),
    }  # fmt: skip


def _calendar(model: NetworkModel) -> str:
    begins, ends = model.start - BEFORE, model.start + dt.timedelta(days=model.days) + AFTER
    week, weekend = "1,1,1,1,1,0,0", "0,0,0,0,0,1,1"
    return _table(
        "service_id,monday,tuesday,wednesday,thursday,friday,saturday,sunday,start_date,end_date",
        [
            (service_id, days, f"{begins:%Y%m%d}", f"{ends:%Y%m%d}")
            for service_id, days in zip(SERVICES, (week, weekend), strict=True)
        ],
    )


def _stops(ways: Sequence[Way]) -> str:
    stops = {stop.stop_id: stop for way in reversed(ways) for stop in way.stops}
    return _table(
        "stop_id,stop_name,stop_lat,stop_lon",
        [
            (stop_id, stop.name, f"{stop.lat_deg:.7f}", f"{stop.lon_deg:.7f}")
            for stop_id, stop in sorted(stops.items())
        ],
    )


def _shapes(ways: Sequence[Way]) -> str:
    return _table(
        "shape_id,shape_pt_lat,shape_pt_lon,shape_pt_sequence",
        [
            (way.way_id, f"{lat_deg:.7f}", f"{lon_deg:.7f}", at)
            for way in ways
            for at, (lat_deg, lon_deg) in enumerate(
                zip(way.street.lats_deg.tolist(), way.street.lons_deg.tolist(), strict=True)
            )
        ],
    )


def _stop_times(trips: Sequence[PlannedTrip]) -> str:
    return _table(
        "trip_id,arrival_time,departure_time,stop_id,stop_sequence,timepoint",
        [
            (trip.trip_id, _clock(arrives_s), _clock(departs_s), stop.stop_id, at + 1, timed)
            for trip in trips
            for at, (stop, arrives_s, departs_s) in enumerate(
                zip(trip.way.stops, trip.arrivals_s, trip.departures_s, strict=True)
            )
            for timed in (int(stop.is_timepoint),)
        ],
    )


def _clock(time_s: int | None) -> str:
    if time_s is None:
        return ""
    return f"{time_s // 3600:02d}:{time_s // 60 % 60:02d}:{time_s % 60:02d}"


def _table(header: str, rows: Iterable[tuple[object, ...]]) -> str:
    lines = [header, *(",".join(map(str, row)) for row in rows)]
    return "\n".join(lines) + "\n"
