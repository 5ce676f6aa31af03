"""Parameters of a question, as text from a URL or a Zenoh selector."""

from typing import Annotated, Literal

import msgspec
import pytest
from msgspec import Meta

from wayline.http_problems import query_problem
from wayline.parameters import describe_parameters, read_parameters
from wayline.query_error import QueryError


class Asked(msgspec.Struct, frozen=True, kw_only=True):
    lat_deg: Annotated[float, Meta(ge=-90.0, le=90.0, description="Where")]
    step_m: Annotated[float, Meta(ge=1.0, le=1000.0)] = 20.0
    way: Literal["there", "back"] | msgspec.UnsetType = msgspec.UNSET


class Named(msgspec.Struct, frozen=True):
    name: str

    def __post_init__(self) -> None:
        if self.name == "none":
            raise ValueError("no such name")


def test_text_becomes_numbers_and_what_is_not_known_is_ignored() -> None:
    asked = read_parameters({"lat_deg": "1e1", "way": "back", "_time": "[now()]"}, Asked)
    assert asked == Asked(lat_deg=10.0, way="back")
    assert read_parameters({"lat_deg": "-90"}, Asked).way is msgspec.UNSET


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "lat_deg: is required"),
        ({"lat_deg": ""}, "lat_deg: Expected `float`, got `str`"),
        ({"lat_deg": "nan"}, "lat_deg: Expected `float` >= -90.0"),
        ({"lat_deg": "inf"}, "lat_deg: Expected `float` <= 90.0"),
        ({"lat_deg": "1", "step_m": "null"}, "step_m: Expected `float`, got `str`"),
        ({"lat_deg": "1", "step_m": "1000.1"}, "step_m: Expected `float` <= 1000.0"),
        ({"lat_deg": "1", "way": "up"}, "way: Invalid enum value 'up'"),
    ],
)
def test_an_unfit_parameter_is_named(given: dict[str, str], message: str) -> None:
    with pytest.raises(QueryError) as refused:
        read_parameters(given, Asked)
    assert (refused.value.status, str(refused.value)) == (422, message)


def test_a_rule_over_the_whole_is_told_in_its_own_words() -> None:
    with pytest.raises(QueryError, match=r"^no such name$") as refused:
        read_parameters({"name": "none"}, Named)
    assert refused.value.parameter is None


def test_openapi_gets_names_limits_and_defaults() -> None:
    assert describe_parameters(Asked) == {
        "parameters": [
            {
                "name": "lat_deg",
                "in": "query",
                "required": True,
                "description": "Where",
                "schema": {"type": "number", "minimum": -90.0, "maximum": 90.0},
            },
            {
                "name": "step_m",
                "in": "query",
                "required": False,
                "schema": {"type": "number", "minimum": 1.0, "maximum": 1000.0, "default": 20.0},
            },
            {
                "name": "way",
                "in": "query",
                "required": False,
                "schema": {"enum": ["back", "there"]},
            },
        ]
    }  # fmt: skip


def test_a_query_error_is_a_problem_with_its_parameter() -> None:
    problem = query_problem(QueryError(422, "is required", parameter="lat_deg"), "a/key")
    assert (problem.status, problem.instance) == (422, "a/key")
    assert problem.detail == "lat_deg: is required"
    assert [(one.name, one.reason) for one in problem.invalid] == [("lat_deg", "is required")]
    assert query_problem(QueryError(404, "no car"), "a/key").invalid == ()
