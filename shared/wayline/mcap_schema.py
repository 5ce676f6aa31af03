"""Pure: the JSON schema of a message as an MCAP file carries it.

Foxglove reads only one plain `type` for each property and follows no reference, so it could not
say that a value may be null. Therefore the root holds both: `$ref` to the exact schema, which is
all that a validator looks at (draft-07 ignores what stands beside a `$ref`), and beside it the
plain shape that viewers read.
"""

from collections.abc import Mapping
from typing import Any

import msgspec

from wayline.messages import Message

SCHEMA_ENCODING = "jsonschema"
DIALECT = "http://json-schema.org/draft-07/schema#"
_NULL = {"type": "null"}
_REF = "#/definitions/{name}"


def schema_name(message: type[Message]) -> str:
    """What viewers call the schema, e.g. wayline.GpsFix."""
    return f"wayline.{message.__name__}"


def message_schema(message: type[Message]) -> dict[str, Any]:
    """Schema of a topic's payload, self-contained: exact behind `$ref`, plain beside it."""
    (ref,), definitions = msgspec.json.schema_components([message], ref_template=_REF)
    plain = _plain(ref, definitions)
    return {"$schema": DIALECT, **ref, **plain, "definitions": definitions}


def schema_json(message: type[Message]) -> bytes:
    """The schema as the file's Schema record holds it."""
    return msgspec.json.encode(message_schema(message))


def _plain(schema: Mapping[str, Any], definitions: Mapping[str, Any]) -> dict[str, Any]:
    """A schema reduced to one `type` everywhere, references and nulls resolved."""
    found = _pointed(schema, definitions)
    plain: dict[str, Any] = {"type": _type_of(found)}
    plain |= {key: found[key] for key in ("title", "description") if key in found}
    if "properties" in found:
        plain["properties"] = {
            name: _plain(value, definitions) for name, value in found["properties"].items()
        }
    if "items" in found:
        plain["items"] = _plain(found["items"], definitions)
    return plain


def _pointed(schema: Mapping[str, Any], definitions: Mapping[str, Any]) -> Mapping[str, Any]:
    """The schema itself behind a reference or a "this or null"."""
    if "$ref" in schema:
        name = schema["$ref"].removeprefix(_REF.format(name=""))
        return _pointed(definitions[name], definitions)
    others = [option for option in schema.get("anyOf", ()) if option != _NULL]
    return _pointed(others[0], definitions) if len(others) == 1 else schema


def _type_of(schema: Mapping[str, Any]) -> str:
    """The `type` of a schema; an enumeration has the type of its values."""
    if "type" in schema:
        return str(schema["type"])
    return "string" if isinstance(schema["enum"][0], str) else "integer"
