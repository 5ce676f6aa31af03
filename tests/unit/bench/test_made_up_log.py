"""The made-up receiver's log is one that gps-ingest reads whole."""

from wayline.inputs import Flush, Sentence
from wayline.messages import GpsFix
from wayline_bench.bare_nmea import FIX_READERS, parse_and_read, split_parse
from wayline_bench.made_up_log import epoch_lines, instant_ns
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.parsing import parse


def test_every_epoch_becomes_a_fix_with_all_its_quality() -> None:
    """At the instant that the bench looks for, and nothing of it is bad."""
    core = GpsIngestCore()
    inputs = [Sentence(0, line) for epoch in range(30) for line in epoch_lines(epoch)]
    messages = [m for each in (*inputs, Flush(0)) for m in core.handle(each, "bench")]
    fixes = [message for message in messages if isinstance(message, GpsFix)]
    assert [fix.t_ns for fix in fixes] == [instant_ns(epoch) for epoch in range(30)]
    assert all(fix.valid and fix.h_std_m and fix.speed_mps and fix.pdop for fix in fixes)
    assert fixes[0].satellites == 20
    assert core.faults == {}


def test_the_yardstick_reads_every_line() -> None:
    """Each has a checksum that pynmea2 accepts, and fields that it can convert."""
    parse_and_read(epoch_lines(0), FIX_READERS)


def test_the_experiment_says_what_the_product_says() -> None:
    """Else its time would be no answer to what a faster parser gives."""
    for line in epoch_lines(7):
        assert split_parse(line) == parse(line)
    assert split_parse(epoch_lines(7)[0].replace("A", "B")) == "checksum"
