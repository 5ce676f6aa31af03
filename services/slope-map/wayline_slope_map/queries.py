"""Answers what is asked of the slope map, for HTTP and Zenoh queries alike.

`parameters` are those of a URL or of a selector; names that are not known are ignored. Every
function raises QueryError: 422 for a missing or unfit parameter, 404 for what is not known.
"""

from collections.abc import Mapping

import msgspec

from wayline.parameters import read_parameters
from wayline_slope_map.answers import (
    LookaheadAnswer,
    ProfileAnswer,
    VehicleLookahead,
    lookahead_answer,
    off_road,
    profile_answer,
)
from wayline_slope_map.book import SlopeBook
from wayline_slope_map.matching import Match
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.questions import (
    AheadParameters,
    LookaheadParameters,
    ProfileParameters,
)


def answer_profile(book: SlopeBook, road_id: str, parameters: Mapping[str, str]) -> ProfileAnswer:
    """A road's grade (`ProfileParameters`)."""
    asked = read_parameters(parameters, ProfileParameters)
    profile = book.profile(road_id)
    return profile_answer(profile, asked.direction, asked.distances_m(profile.road))


def answer_lookahead(book: SlopeBook, parameters: Mapping[str, str]) -> LookaheadAnswer:
    """The road ahead of a place (`LookaheadParameters`): the queryable `@query/lookahead`."""
    asked = read_parameters(parameters, LookaheadParameters)
    return _ahead(book.nearest(asked.lat_deg, asked.lon_deg, asked.heading_deg), asked)


def answer_vehicle_lookahead(
    book: SlopeBook, vehicle_id: str, parameters: Mapping[str, str]
) -> VehicleLookahead:
    """The road ahead of a vehicle (`AheadParameters`), where its `horizon` has it."""
    asked = read_parameters(parameters, AheadParameters)
    age_s = book.vehicle_age_s(vehicle_id)
    ahead = _ahead(book.place(vehicle_id), asked)
    return VehicleLookahead(
        vehicle_id=vehicle_id, age_s=round(age_s, 2), **msgspec.structs.asdict(ahead)
    )


def _ahead(place: tuple[RoadProfile, Match] | None, asked: AheadParameters) -> LookaheadAnswer:
    if place is None:
        return off_road(asked.distances_m())
    profile, match = place
    return lookahead_answer(profile, match, length_m=asked.length_m, step_m=asked.step_m)
