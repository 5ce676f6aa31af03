"""What a vehicle's drives have taught and what of them was left out, as the answer over HTTP."""

from collections.abc import Callable
from typing import Annotated, NamedTuple

import msgspec
import sqlalchemy as sa
from msgspec import Meta

from wayline.keys import is_vehicle_id
from wayline.query_error import QueryError
from wayline.rfc3339 import rfc3339
from wayline_slope_map.answers import WAYS, Way
from wayline_slope_map.ledger import ListedRun, newest_runs
from wayline_slope_map.left_out import Altimeter, LeftOut
from wayline_slope_map.left_out_rows import newest

LIMIT_MAX = 1_000


class DrivesParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How much is told."""

    limit: Annotated[
        int, Meta(ge=1, le=LIMIT_MAX, description="So many runs, and so many parts, at most")
    ] = 100


class Kept(NamedTuple):
    """What a database has of a vehicle, the newest first."""

    runs: list[ListedRun]
    left_out: list[LeftOut]


Asked = Callable[[str, int], Kept | None]
"""What is kept of a vehicle, so much of each at most; None while the database is away."""


class LearnedRun(msgspec.Struct, frozen=True, kw_only=True):
    """A run over a road that was merged into the map."""

    run: str
    """Its name, for `wayline slope withdraw`."""
    road_id: str
    direction: Way
    start: str
    end: str
    state: str
    """merged, withdrawn, or fixed: merged before runs were kept."""


class LeftOutPart(msgspec.Struct, frozen=True, kw_only=True):
    """A part of a drive that teaches nothing, or a sensor that was not used over it."""

    sensor: Altimeter | None
    """Null where the whole part is left out."""
    reason: str
    start: str
    end: str
    length_m: float
    start_lat_deg: float | None
    start_lon_deg: float | None
    end_lat_deg: float | None
    end_lon_deg: float | None


class VehicleRuns(msgspec.Struct, frozen=True, kw_only=True):
    """What was learned of a vehicle's drives and what was left out, the newest first."""

    vehicle_id: str
    runs: tuple[LearnedRun, ...]
    left_out: tuple[LeftOutPart, ...]


def kept_of(connection: sa.Connection, vehicle_id: str, limit: int) -> Kept:
    """What is kept of a vehicle, so much of each at most."""
    runs = newest_runs(connection, vehicle_id, limit)
    return Kept(runs, newest(connection, vehicle_id, limit))


def vehicle_runs(asked: Asked, vehicle_id: str, limit: int, *, is_heard: bool) -> VehicleRuns:
    """The answer for a vehicle. Raises QueryError: 404 for an unknown one, 503 for no database."""
    if not is_vehicle_id(vehicle_id):
        raise QueryError(404, f"{vehicle_id} is no vehicle id")
    kept = asked(vehicle_id, limit)
    if kept is None:
        raise QueryError(503, "the slope map's database is away")
    if not (kept.runs or kept.left_out or is_heard):
        raise QueryError(404, f"nothing is kept of a vehicle {vehicle_id}")
    return VehicleRuns(
        vehicle_id=vehicle_id,
        runs=tuple(_learned(run) for run in kept.runs),
        left_out=tuple(_part(left_out) for left_out in kept.left_out),
    )


def _learned(run: ListedRun) -> LearnedRun:
    return LearnedRun(
        run=run.run,
        road_id=run.road_id,
        direction=WAYS[run.direction],
        start=rfc3339(run.start_ns),
        end=rfc3339(run.end_ns),
        state=run.state,
    )


def _part(left_out: LeftOut) -> LeftOutPart:
    return LeftOutPart(
        sensor=left_out.sensor,
        reason=left_out.reason,
        start=rfc3339(left_out.start_ns),
        end=rfc3339(left_out.end_ns),
        length_m=left_out.length_m,
        start_lat_deg=left_out.start_lat_deg,
        start_lon_deg=left_out.start_lon_deg,
        end_lat_deg=left_out.end_lat_deg,
        end_lon_deg=left_out.end_lon_deg,
    )
