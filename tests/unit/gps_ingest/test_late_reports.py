"""Reports that come twice or after later ones, and a clock that stepped."""

from wayline.inputs import PositionReport
from wayline.messages import GpsFix
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.late_reports import STEPPED_AFTER

START_NS, EVERY_NS = 1_700_000_000_000_000_000, 30_000_000_000


def instants(steps: list[int]) -> tuple[list[int], int]:
    """Which steps' instants fixes have, and how many reports were bad input."""
    core = GpsIngestCore()
    fixes: list[GpsFix] = []
    for step in steps:
        t_ns = START_NS + step * EVERY_NS
        report = PositionReport(
            t_ns=t_ns, lat_deg=48.0 + step * 1e-3, lon_deg=11.0, received_ns=None
        )
        fixes += [each for each in core.handle(report, "x") if isinstance(each, GpsFix)]
    return [(fix.t_ns - START_NS) // EVERY_NS for fix in fixes], core.bad_input


def test_a_report_that_comes_twice_or_late_is_counted_and_moves_no_other() -> None:
    assert instants([0, 1, 1, 2, 4, 3, 5, 5, 6, 8, 7, 9]) == ([0, 1, 2, 4, 5, 6, 8, 9], 4)


def test_a_clock_that_stepped_back_goes_on() -> None:
    told, _ = instants([100, 101, 102, *range(10, 30)])
    assert len(told) == 3 + 20 - (STEPPED_AFTER - 1)
    assert told == sorted(told)
