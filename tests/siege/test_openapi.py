"""Whatever is asked of a service's paths, the answer is one that its OpenAPI document tells of."""

from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from schemathesis.checks import not_a_server_error
from schemathesis.core.result import Ok
from schemathesis.specs.openapi.checks import positive_data_acceptance

from besieged import Besieged, Bus
from lasting import examples
from siege.conftest import SERVICES

# a stream without an end cannot be read to its end
ENDLESS = {"/v1/stream"}
# where one parameter bounds another, or a text has a form, more is refused than a schema can say;
# 503 of a probe is an answer, and every other status is held to the document
EXCLUDED: list[Any] = [not_a_server_error, positive_data_acceptance]


@pytest.mark.parametrize("service", SERVICES)
def test_every_answer_is_as_the_document_says(besieged: Besieged, bus: Bus, service: str) -> None:
    schema = schemathesis.openapi.from_url(f"{besieged.system.url(service)}/openapi.json")
    for found in schema.get_all_operations():
        assert isinstance(found, Ok), found
        operation = found.ok()
        if operation.path in ENDLESS:
            continue

        @settings(
            max_examples=examples(10),
            deadline=None,
            suppress_health_check=list(HealthCheck),
            database=None,
        )
        @given(case=operation.as_strategy())
        def ask(case: Any) -> None:
            case.call_and_validate(timeout=10.0, excluded_checks=EXCLUDED)

        ask()
    besieged.assert_stands()


@pytest.mark.parametrize("service", SERVICES)
def test_every_parameter_is_described(besieged: Besieged, service: str) -> None:
    paths = besieged.get(service, "/openapi.json")["paths"]
    unsaid = [
        (path, parameter["name"])
        for path, operations in paths.items()
        for operation in operations.values()
        for parameter in operation.get("parameters", ())
        if not parameter.get("description")
    ]
    assert unsaid == []
