"""Pure: the parameters of a question, the same in a URL and in a Zenoh selector.

A Struct is the one place that says what they are; their names are its fields' names. Parameters
that it does not name are ignored.
"""

import re
from collections.abc import Mapping
from typing import Any, TypeVar

import msgspec

from wayline.query_error import QueryError

Parameters = TypeVar("Parameters", bound=msgspec.Struct)
WRONG = re.compile(r"(?P<reason>.*) - at `\$\.(?P<name>\w+)`$")
MISSING = re.compile(r"Object missing required field `(?P<name>\w+)`$")


def read_parameters(given: Mapping[str, str], struct: type[Parameters]) -> Parameters:
    """The parameters as a Struct. Raises QueryError (422) for a missing or unfit one."""
    try:
        return msgspec.convert(dict(given), struct, strict=False)
    except msgspec.ValidationError as error:
        raise _query_error(str(error)) from None


def _query_error(text: str) -> QueryError:
    if wrong := WRONG.match(text):
        return QueryError(422, wrong["reason"], parameter=wrong["name"])
    if missing := MISSING.match(text):
        return QueryError(422, "is required", parameter=missing["name"])
    return QueryError(422, text)


def describe_parameters(struct: type[msgspec.Struct]) -> dict[str, Any]:
    """The parameters of a path for OpenAPI (`openapi_extra`)."""
    _, schemas = msgspec.json.schema_components([struct])
    schema = schemas[struct.__name__]
    required = schema.get("required", ())
    return {
        "parameters": [
            _described(name, schema, name in required)
            for name, schema in schema["properties"].items()
        ]
    }


def _described(name: str, schema: dict[str, Any], required: bool) -> dict[str, Any]:
    said = {key: schema[key] for key in ("description",) if key in schema}
    limits = {key: value for key, value in schema.items() if key not in said}
    return {"name": name, "in": "query", "required": required, **said, "schema": limits}
