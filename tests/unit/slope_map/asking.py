"""Roads as the slope map knows them, and asking its app about them."""

from typing import Any

import msgspec
from fastapi.testclient import TestClient

from unit.slope_map.hilly_road import (
    SECOND_NS,
)
from wayline.digits import rounded
from wayline.http_settings import HttpSettings
from wayline.messages import HorizonPoint
from wayline.rfc3339 import rfc3339
from wayline_slope_map.app import create_slope_app
from wayline_slope_map.book import SlopeBook
from wayline_slope_map.drives import Kept
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import FinishedRun
from wayline_slope_map.sums import BinEstimate, estimate, run_sums

NOW_NS = 7 * SECOND_NS


def profile_of(*runs: FinishedRun) -> RoadProfile:
    bins: dict[int, dict[int, BinEstimate]] = {
        run.direction: {
            at.bin_index: estimate(
                run_sums(at.grade_pct, at.grade_std_pct, at.alt_m, at.alt_std_m, run.end_ns)
            )
            for at in run.bins
            if at.sensor == "fused"
        }
        for run in runs
    }
    return RoadProfile(runs[0].road, bins)


def client(
    book: SlopeBook, settings: HttpSettings | None = None, kept: Kept | None = None
) -> TestClient:
    """An app beside a database that has so much of every vehicle; None is one that is away."""
    app = create_slope_app(book, settings or HttpSettings(), drives=lambda *_: kept)
    return TestClient(app, base_url="http://localhost")


def asked(book: SlopeBook, path: str, **parameters: float | str) -> Any:
    answer = client(book).get(path, params=parameters)
    assert answer.status_code == 200, answer.text
    return answer.json()


def path_of(profile: RoadProfile, document: str = "profile") -> str:
    return f"/v1/roads/{profile.road.road_id}/{document}"


def shown(point: HorizonPoint) -> dict[str, Any]:
    """A point of the core as HTTP shows it."""
    fields = msgspec.structs.asdict(point)
    updated_ns = fields.pop("updated_ns")
    updated = None if updated_ns is None else rfc3339(updated_ns)
    return dict(rounded({**fields, "updated": updated}))
