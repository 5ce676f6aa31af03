"""What health says of a receiver."""

import pytest

from wayline_gps_ingest.condition import Condition

WELL = {"byte_age_s": 0.1, "sentence_age_s": 0.1, "fix_age_s": 0.2}


@pytest.mark.parametrize(
    ("facts", "problem"),
    [
        (WELL, None),
        (WELL | {"fix_age_s": 9.0}, "without a fix"),
        (WELL | {"fix_age_s": None}, "without a fix"),
        ({"byte_age_s": 0.1, "sentence_age_s": 7.0}, "sends nothing readable"),
        ({"byte_age_s": 6.0}, "silent"),
        ({"link_error": "is not there"}, "not connected (is not there)"),
    ],
)
def test_the_deepest_cause_is_the_problem(facts: dict[str, float], problem: str | None) -> None:
    """A receiver that is not there has no fix either, but that is not what is to be mended."""
    condition = Condition(url="udp://:1", **facts)  # type: ignore[arg-type]
    assert condition.problem == problem


def test_the_line_tells_ages_rate_and_what_was_dropped() -> None:
    """Everything that a technician asks for first."""
    condition = Condition(
        url="serial:///dev/ttyUSB0",
        note="9600 baud",
        byte_age_s=0.1,
        sentence_age_s=0.1,
        reconnections=2,
        faults={"torn": 1, "checksum": 3},
    )
    assert condition.text == (
        "serial:///dev/ttyUSB0: without a fix, 9600 baud, last sentence 0.1 s ago, "
        "last fix never, 2 reconnections, 3 checksum, 1 torn"
    )
