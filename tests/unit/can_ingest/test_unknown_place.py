"""0 degrees north and east is a receiver that does not know, on a bus too."""

import cantools
import pytest
from cantools.database.can import Database

from builders import frame
from wayline.drive import CanSource, SignalMapping, Vehicle
from wayline.messages import GpsFix
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.mapping import compile_mapping

DBC = """
VERSION ""
BU_: ECU
BO_ 260 Place: 8 ECU
 SG_ Latitude : 0|32@1- (1e-07,0) [-90|90] "deg" ECU
 SG_ Longitude : 32|32@1- (1e-07,0) [-180|180] "deg" ECU
"""


@pytest.mark.parametrize(
    ("data", "valid"),
    [("0000000000000000", False), ("0100000000000000", True), ("0000000001000000", True)],
)
def test_a_place_of_zeros_is_no_fix(data: str, valid: bool) -> None:
    """One step beside it is a place."""
    database = cantools.database.load_string(DBC, strict=False)
    assert isinstance(database, Database)
    source = CanSource(
        path="x.log",
        signals={
            "gps_fix.lat_deg": SignalMapping(message="Place", signal="Latitude"),
            "gps_fix.lon_deg": SignalMapping(message="Place", signal="Longitude"),
        },
    )
    mapping = compile_mapping(source, [database], Vehicle(), "drive.toml")
    core = CanIngestCore(source, mapping, Vehicle())
    (fix,) = core.handle(frame(0.0, 260, data), "can-ingest")
    assert isinstance(fix, GpsFix)
    assert (fix.valid, fix.lat_deg is not None, fix.mode) == (valid, valid, 2 if valid else 1)
