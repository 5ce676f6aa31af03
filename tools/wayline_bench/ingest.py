"""`bench ingest`: what the ingest services cost beside bare parsers, and live beside bare Zenoh."""

import os
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from unittest.mock import patch

from wayline.codec import encode
from wayline.framing import SentenceSplitter
from wayline.inputs import Sentence
from wayline_bench.bare_nmea import ALL_READERS, FIX_READERS, parse_and_read, split_parse
from wayline_bench.ingest_can import frame_rows
from wayline_bench.ingest_can_live import bus_rows
from wayline_bench.ingest_live import live_rows
from wayline_bench.made_up_log import epoch_lines
from wayline_bench.rounds import Say, Work, in_turns
from wayline_bench.row import Row, compared
from wayline_gps_ingest import core
from wayline_gps_ingest.core import GpsIngestCore

ROUNDS = 15
MADE_UP_EPOCHS = 800
SENTENCE_BAR = 1.5
UNIT = "us a sentence"
RECORDED = Path("nmea", "munich.nmea")


def bench(say: Say) -> list[Row]:
    """Every row. Needs no recorded data, but reads `WAYLINE_DATA` where it is set."""
    logs = {"10 Hz, made up": [line for n in range(MADE_UP_EPOCHS) for line in epoch_lines(n)]}
    recorded = Path(os.environ.get("WAYLINE_DATA", "")) / RECORDED
    if recorded.is_file():
        logs = {RECORDED.name: recorded_lines(recorded)} | logs
    else:
        reason = f"no {RECORDED} in the folder that WAYLINE_DATA names"
        print(f"{RECORDED.name} is left out: {reason}", file=sys.stderr)
    rows = [row for name, lines in logs.items() for row in sentence_rows(name, lines, say)]
    return [*rows, *live_rows(say), *frame_rows(say), *bus_rows(say)]


def recorded_lines(path: Path) -> list[str]:
    """The sentences of a log as text, its comments and line ends removed."""
    lines = path.read_text(encoding="latin-1").splitlines()
    return [line.rstrip() for line in lines if line.startswith("$")]


def sentence_rows(name: str, lines: Sequence[str], say: Say) -> list[Row]:
    """One log: sentence to encoded message, beside `pynmea2.parse` of the same lines."""
    works: dict[str, Work] = {
        "fix": partial(parse_and_read, lines, FIX_READERS),
        "all": partial(parse_and_read, lines, ALL_READERS),
        "ours": partial(publish, lines),
        "received": partial(publish_received, [f"{line}\r\n".encode() for line in lines]),
        "split": partial(publish_split, lines),
    }
    spent_s = in_turns(works, ROUNDS, lambda progress: say(f"{name}: {progress}"))
    us = {work: [each * 1e6 / len(lines) for each in rounds] for work, rounds in spent_s.items()}
    fix, every = "pynmea2.parse, a fix's fields read", "pynmea2.parse, the sky's fields read too"

    def row(what: str, ours: str, yardstick: str, bar: float | None = None) -> Row:
        yardstick_name = fix if yardstick == "fix" else every
        title = f"{name}: {what}"
        return compared(title, us[ours], us[yardstick], yardstick_name, unit=UNIT, bar=bar)

    return [
        row("sentence to gps_fix", "ours", "fix", SENTENCE_BAR),
        row("sentence to gps_fix and gps_sky", "ours", "all", SENTENCE_BAR),
        row("a receiver's bytes to gps_fix", "received", "fix"),
        row("experiment: split in place of pynmea2", "split", "fix"),
    ]


def publish(lines: Sequence[str]) -> None:
    """Each line as a sentence through a core, its messages encoded as they go on the bus."""
    ingest = GpsIngestCore()
    for line in lines:
        for message in ingest.handle(Sentence(0, line), "bench"):
            encode(message)


def publish_received(received: Sequence[bytes]) -> None:
    """Bytes to encoded messages, with the search for sentences that live bytes go through."""
    ingest, splitter = GpsIngestCore(), SentenceSplitter()
    for chunk in received:
        for sentence in splitter.feed(chunk):
            for message in ingest.handle(Sentence(0, sentence), "bench"):
                encode(message)


def publish_split(lines: Sequence[str]) -> None:
    """Sentences to encoded messages as by `publish`, with the experiment in pynmea2's place."""
    with patch.object(core, "parse", split_parse):
        publish(lines)
