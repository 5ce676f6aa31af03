"""The made-up bus is one that can-ingest reads as the bench expects."""

import tomllib
from itertools import islice

import cantools
import msgspec
import pytest
from cantools.database.can import Database

from wayline.drive import CanSource, Vehicle
from wayline.inputs import Frame
from wayline.messages import Message, Odometer
from wayline_bench.made_up_bus import DBC, MAPPED_IDS, MAPPING, NUMBERED_ID, frame, identifiers
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.mapping import compile_mapping

START_NS = 1_700_000_000_000_000_000


def messages_of(identifier: int, number: int) -> list[Message]:
    """What a frame becomes."""
    table = tomllib.loads(MAPPING)["can"]
    source = msgspec.convert({"path": "x.log", **table}, CanSource)
    database = cantools.database.load_string(DBC)
    assert isinstance(database, Database)
    mapping = compile_mapping(source, [database], Vehicle(), "test")
    core = CanIngestCore(source, mapping, Vehicle())
    data = bytes(frame(identifier, number).data)
    return list(core.handle(Frame(START_NS, "can0", identifier, False, data), "bench"))


@pytest.mark.parametrize("identifier", MAPPED_IDS)
def test_a_mapped_frame_becomes_one_message_with_a_value(identifier: int) -> None:
    """So that messages heard can be counted against frames sent."""
    (message,) = messages_of(identifier, 7)
    values = msgspec.structs.asdict(message)
    assert any(value is not None for name, value in values.items() if name != "t_ns")


def test_a_numbered_frame_tells_its_number() -> None:
    """The bench knows by it when the frame was sent."""
    assert messages_of(NUMBERED_ID, 123_456) == [Odometer(t_ns=START_NS, distance_m=123_456.0)]


@pytest.mark.parametrize(("only_mapped", "share"), [(False, 0.1), (True, 1.0)])
def test_a_tenth_of_the_bus_or_all_of_it_is_mapped(only_mapped: bool, share: float) -> None:
    """And the rest becomes nothing."""
    order = list(islice(identifiers(only_mapped=only_mapped), 4000))
    assert sum(each in MAPPED_IDS for each in order) == 4000 * share
    assert all(messages_of(each, 0) == [] for each in {*order} - {*MAPPED_IDS})
