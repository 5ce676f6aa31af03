"""Whatever bytes come, the core goes on, and counts what it could not use."""

from itertools import pairwise

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from unit.gps_ingest.receiver import fixes, flush, gga, gsa, hear, line, rmc
from wayline.framing import SentenceSplitter, split_sentences
from wayline.inputs import PositionReport, Sentence, Tick
from wayline.messages import GpsSky
from wayline_gps_ingest.core import GpsIngestCore

KINDS = ("GGA", "RMC", "GSA", "GSV", "GST", "VTG", "GLL", "GNS", "ZDA", "TXT")
FIELD = st.one_of(
    st.sampled_from(
        ["", "A", "V", "N", "E", "M", "1", "0", "3", "120000.5", "4807.038", "01131.0"]
    ),
    st.text(alphabet="0123456789.-+eNaE_ \x00\xb2\xff", max_size=12),
)
BODY = st.builds(
    lambda talker, kind, fields: f"{talker}{kind}," + ",".join(fields),
    st.sampled_from(["GP", "GN", "GL", "II", "P1"]),
    st.sampled_from(KINDS),
    st.lists(FIELD, max_size=24),
)


def checked(body: str) -> str:
    """A sentence with the right checksum, so that its fields are read."""
    total = 0
    for character in body:
        total ^= ord(character)
    return f"${body}*{total & 0xFF:02X}"


@given(st.lists(st.binary(max_size=200), max_size=20))
def test_no_bytes_raise(chunks: list[bytes]) -> None:
    core = GpsIngestCore()
    for chunk in chunks:
        text = chunk.decode("latin-1")
        hear(core, [text, f"${text}", *split_sentences(text)])
    flush(core)


@settings(max_examples=300)
@given(st.lists(st.one_of(BODY.map(checked), BODY.map("${}".format)), max_size=30))
def test_no_fields_raise_and_time_never_goes_back(texts: list[str]) -> None:
    core = GpsIngestCore()
    messages = hear(core, [rmc("120000"), *texts, rmc("120001"), rmc("120002")])
    messages += core.handle(Tick(10**18), "test")
    messages += flush(core)
    assert all(first.t_ns <= second.t_ns for first, second in pairwise(messages))


REAL = (
    gga("120000"),
    rmc("120000"),
    gsa(),
    line("GPGSV,1,1,01,07,46,259,26,1"),
    line("GNGNS,120000,4807.038,N,01131.000,E,AN,12,0.93,1482.5,-16.5,,"),
    line("GPGLL,4807.038,N,01131.000,E,120000,A,D"),
    line("GPGST,120000,5.0,,,,3.0,4.0,7.5"),
    line("GPVTG,054.7,T,034.4,M,010.0,N,018.5,K,A"),
    line("GPZDA,120000,04,07,2012,,"),
    line("PGRMZ,48,f,3"),
    line("PQGSV,1,1,01,01,46,259,26,1"),
)
CUTS = st.tuples(st.sampled_from(REAL), st.integers(0, 80), st.integers(0, 80), st.booleans())


@settings(max_examples=300)
@given(st.lists(st.one_of(st.binary(max_size=20), CUTS), max_size=30))
@example([(line("PQGSV,"), 0, 1, True)])  # found by tests/fuzz
def test_no_torn_and_spliced_sentences_raise(
    parts: list[bytes | tuple[str, int, int, bool]],
) -> None:
    """Real sentences without what stands between two places, some with a right checksum again."""
    core, splitter = GpsIngestCore(), SentenceSplitter()
    for part in parts:
        chunk = part if isinstance(part, bytes) else without(*part)
        hear(core, splitter.feed(chunk))
    hear(core, splitter.end())
    flush(core)


def without(sentence: str, start: int, length: int, vouched: bool) -> bytes:
    """A sentence without a part of it."""
    body = sentence[1:].partition("*")[0]
    rest = body[: 5 + start] + body[5 + start + length :]
    return (checked(rest) if vouched else f"${rest}*00").encode()


@given(st.integers(0, 2**20), st.binary(min_size=1, max_size=1))
def test_a_changed_byte_is_one_bad_checksum(place: int, byte: bytes) -> None:
    sentence = gga("120000")
    end = sentence.index("*")
    at = 7 + place % (end - 7)
    changed = sentence[:at] + byte.decode("latin-1") + sentence[at + 1 :]
    core = GpsIngestCore()
    hear(core, [changed])
    expected = {} if changed == sentence else {"checksum": 1}
    if byte not in b"*$":
        assert core.faults == expected


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("$GPGGA,163409.348,5916.4824,N,01707.3605,E,1,10,1.2,26.9,M,,0000*37", "checksum"),
        ("$PGRME,9.1,M,15.0,M,12.0,M*00", "checksum"),
        ("$GPGGA,163409.348,5916.48", "torn"),
        ("", "malformed"),
        ("$GPGGA,1634*zz", "malformed"),
        (gga("250000"), "field"),
        (gga("120000", position="4899.038,N,01131.000,E"), "field"),
        (rmc("120000", date="310294"), "field"),
    ],
)
def test_bad_input_is_counted_by_reason(text: str, reason: str) -> None:
    core = GpsIngestCore()
    assert hear(core, [text]) + flush(core) == []
    assert core.faults == {reason: 1}
    assert core.bad_input == 1


@pytest.mark.parametrize(
    "text", ["$PGRMM,WGS 84*06", "$GPBOD,,T,,M,,*47", "!AIVDM,1,1,,A,x,0", "!GPRMC,120000,V"]
)
def test_sentences_of_no_interest_are_not_bad(text: str) -> None:
    core = GpsIngestCore()
    hear(core, [text])
    assert core.bad_input == 0


def test_a_receiver_without_checksums_is_understood() -> None:
    core = GpsIngestCore()
    hear(core, [text.partition("*")[0] for text in (rmc("120000"), gga("120000"), gsa())])
    (fix,) = fixes(flush(core))
    assert fix.alt_m == 545.4
    assert core.bad_input == 0


def test_half_a_sentence_of_a_receiver_with_checksums_is_torn() -> None:
    core = GpsIngestCore()
    cut = rmc("120001").partition(".1,W*")[0]
    hear(core, [rmc("120000"), cut])
    assert core.faults == {"torn": 1}


def test_a_field_that_cannot_be_is_not_bad_while_there_is_no_fix() -> None:
    """tn200 writes 36000.0000 degrees while it has no fix."""
    core = GpsIngestCore()
    hear(core, [line("GPRMC,000416.984,V,36000.0000,N,72000.0000,E,0.000000,,260120,,")])
    assert core.bad_input == 0


def test_a_stream_that_never_tells_the_time_does_not_fill_memory() -> None:
    core = GpsIngestCore()
    hear(core, [line(f"GPGSV,1,1,01,{number},46,259,26") for number in range(1, 1000)])
    _, sky = hear(core, [rmc("120000")]) + flush(core)
    assert isinstance(sky, GpsSky)
    assert len(sky.satellites) == 64


def test_a_position_report_is_a_fix_even_where_the_bus_stands() -> None:
    core = GpsIngestCore(gps_latency_s=1.0)
    reports = [PositionReport(second * 10**9, 38.9, -77.0, 360.0) for second in (100, 130)]
    out = fixes(message for report in reports for message in core.handle(report, "test"))
    assert [fix.t_ns for fix in out] == [99 * 10**9, 129 * 10**9]
    assert [(fix.valid, fix.mode, fix.fix, fix.course_deg) for fix in out] == [
        (True, 2, "gps", 0.0)
    ] * 2


@pytest.mark.parametrize(("lat_deg", "lon_deg"), [(91.0, 0.0), (0.0, 181.0), (0.0, 0.0)])
def test_a_report_outside_the_world_is_counted(lat_deg: float, lon_deg: float) -> None:
    core = GpsIngestCore()
    assert core.handle(PositionReport(10**18, lat_deg, lon_deg), "test") == []
    assert core.faults == {"report": 1}


def test_other_inputs_are_none_of_its_business() -> None:
    core = GpsIngestCore()
    assert core.handle(fixes(hear(core, [rmc("120000")]) + flush(core))[0], "test") == []


def test_noise_before_a_sentence_is_cut_off() -> None:
    core = GpsIngestCore()
    core.handle(Sentence(None, "\xb5b\x01\x07$" + rmc("120000")), "test")
    assert len(fixes(flush(core))) == 1
