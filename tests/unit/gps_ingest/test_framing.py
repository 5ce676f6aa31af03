"""Bytes become sentences in whatever pieces they come and whatever is among them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unit.gps_ingest.receiver import gga, rmc
from wayline.framing import UNFINISHED_MAX, SentenceSplitter, split_sentences

UBX = b"\xb5b\x01\x07\x04\x00$\r\n*\x17\x33"
NOISE = st.one_of(
    st.binary(max_size=30), st.sampled_from([UBX, b"\xd3\x00\x13>", b"\x10\x03", b"$GPRM"])
)
PIECES = st.lists(
    st.one_of(NOISE, st.sampled_from([f"{gga('120000')}\r\n".encode(), rmc("120000").encode()])),
    max_size=20,
)


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("$GPRM$GPRMC,,V,,,*00", ["$GPRMC,,V,,,*00"]),
        ("$GPGGA,030130$GPGLL,1,A*41", ["$GPGGA,030130", "$GPGLL,1,A*41"]),
        ("$GPAAA,1*00$GPBBB,2*00", ["$GPAAA,1*00", "$GPBBB,2*00"]),
        ("$GPTXT,price 5$ or 6!*00", ["$GPTXT,price 5$ or 6!*00"]),
        ("!AIVDM,1,1,,A,x,0*5C", ["!AIVDM,1,1,,A,x,0*5C"]),
        ("$GPRMC,cut", ["$GPRMC,cut"]),
        ("12 $ 13 ! 14", []),
    ],
)
def test_a_line_is_split_where_sentences_start(line: str, expected: list[str]) -> None:
    assert split_sentences(line) == expected


def test_a_sentence_is_handed_out_with_its_last_digit() -> None:
    """Waiting for the line's end would wait for the next read, where a link cuts between them."""
    splitter = SentenceSplitter()
    assert splitter.feed(gga("120000")[:-1].encode()) == []
    assert splitter.feed(gga("120000")[-1:].encode()) == [gga("120000")]
    assert splitter.feed(b"\r\n") == []


def test_a_sentence_without_checksum_ends_with_its_line() -> None:
    splitter = SentenceSplitter()
    assert splitter.feed(b"$GPGLL,1") == []
    assert splitter.feed(b",2\r") == ["$GPGLL,1,2"]


def test_binary_messages_are_skipped_to_the_next_sentence() -> None:
    splitter = SentenceSplitter()
    assert splitter.feed(UBX + gga("120000").encode() + UBX) == [gga("120000")]
    assert splitter.feed(rmc("120000").encode()) == [rmc("120000")]


def test_a_datagram_ends_with_its_last_byte() -> None:
    splitter = SentenceSplitter()
    assert splitter.feed(b"$GPGLL,1,2") == []
    assert splitter.end() == ["$GPGLL,1,2"]
    assert splitter.end() == []


def test_binary_without_line_ends_does_not_fill_memory() -> None:
    splitter = SentenceSplitter()
    for _ in range(100):
        splitter.feed(b"\x00" * 1000)
    assert len(splitter.__dict__["_unfinished"]) == UNFINISHED_MAX


@given(PIECES, st.integers(1, 40))
def test_how_the_bytes_are_cut_does_not_matter(pieces: list[bytes], size: int) -> None:
    """Any cut gives the sentences of the whole."""
    whole = b"".join(pieces)
    splitter = SentenceSplitter()
    found = []
    for start in range(0, len(whole), size):
        found += splitter.feed(whole[start : start + size])
    assert found + splitter.end() == split_sentences(whole.decode("latin-1"))
