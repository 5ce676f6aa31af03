"""Pure: `[road]` of a scenario: what kind of road is driven, and what is along it."""

from typing import Annotated, Literal

from msgspec import Meta

from wayline.strict import Strict
from wayline_simulator.road_plan import Stretch

Kind = Literal["motorway", "main", "urban", "hills", "eight", "garage", "file"]
Positive = Annotated[float, Meta(gt=0.0)]


class RoadModel(Strict, frozen=True, kw_only=True):
    """`[road]`"""

    kind: Kind = "main"
    length_m: Positive | None = None
    """Of one lap; default by kind. A garage and a file have their own."""
    loop: bool | None = None
    """Default: hills and eight (which always are), and a file that says so."""
    laps: Annotated[int, Meta(ge=1)] = 1
    """How often a loop is driven."""
    lat_deg: Annotated[float, Meta(ge=-80.0, le=80.0)] = 59.2
    """South-west of Stockholm, where papers/004 was driven."""
    lon_deg: Annotated[float, Meta(ge=-180.0, le=180.0)] = 17.6
    heading_deg: float = 70.0
    alt_m: float = 60.0
    path: str | None = None
    """Of kind `file`: GeoJSON, GPX, truth.csv or the folder of a drive."""
    limit_mps: Positive | None = None
    """Of kind `file` without planned speeds; default 50 km/h."""
    relief: Annotated[float, Meta(gt=0.0, le=1.0)] = 1.0
    """Of kinds `main`, `hills` and `urban`: grades as a share of what such a road may have."""
    open_sky: bool = False
    """Neither trees nor houses by the road."""
    tunnels: int | tuple[Stretch, ...] = 0
    """How many, or where."""
    canyons: tuple[Stretch, ...] = ()
    """Stretches between high buildings."""
    stops: Annotated[int, Meta(ge=0)] = 0
    """Bus stops, about evenly spread; a route's own come besides."""
