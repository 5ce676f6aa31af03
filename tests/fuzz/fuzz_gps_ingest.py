"""Feeds gps-ingest damaged recordings for some minutes: `fuzz_gps_ingest.py --minutes 10`.

Sentences of recorded logs (WAYLINE_DATA) are cut, spliced, flipped and given other fields, half of
them with a right checksum again so that their fields are read; binary noise goes in between. One
core lives through it all, so that a leak shows; each round has a fresh one too. What must hold: no
exception, instants that never decrease, messages within the bounds of their fields, memory that
does not grow. Ends with 1 if something does not; the same seed runs the same rounds.
"""

import argparse
import logging
import os
import random
import resource
import sys
import time
from collections.abc import Callable, Iterator
from functools import reduce
from operator import xor
from pathlib import Path

from wayline.codec import decode, encode
from wayline.framing import SentenceSplitter
from wayline.inputs import Sentence, Tick
from wayline_gps_ingest.core import GpsIngestCore

log = logging.getLogger("fuzz")
ROUND = 200
"""Sentences; a tick ends a round."""
WARM_ROUNDS = 200
"""Caches are full by then; memory is compared from there."""
GROWTH_MAX_KB = 20_000
FIELDS = (
    "",
    "A",
    "V",
    "N",
    "S",
    "0",
    "-1",
    "1e309",
    "0NaN",
    "9" * 40,
    "120000",
    "4807.038",
    "\xb2",
)
NOISE = (b"\xb5b\x01\x07\x04\x00$\r\n*\x17\x33", b"\xd3\x00\x13>", b"\xa0\xa2\x00\x02", b"\x10\x03")


def main() -> int:
    """Run rounds until the time is over."""
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    fuzzer = Fuzzer(recorded_sentences())
    end_s = time.monotonic() + options.minutes * 60.0
    rounds, warm_kb = 0, 0
    while time.monotonic() < end_s:
        try:
            fuzzer.run(random.Random(options.seed + rounds))
        except Exception:
            log.exception("round %d failed", rounds)
            return 1
        rounds += 1
        if rounds == WARM_ROUNDS:
            warm_kb = peak_kb()
    grown_kb = peak_kb() - warm_kb if rounds > WARM_ROUNDS else 0
    log.info("%d rounds, %d sentences, %d messages, 0 exceptions", rounds, *fuzzer.counts)
    log.info("memory: %d kB after %d rounds, %d kB at the end", warm_kb, WARM_ROUNDS, peak_kb())
    log.info("bad input by reason: %s", fuzzer.core.faults)
    return int(grown_kb > GROWTH_MAX_KB)


def peak_kb() -> int:
    """Most memory that this process has held."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def recorded_sentences() -> list[bytes]:
    """The lines of every recorded log."""
    folder = Path(os.environ["WAYLINE_DATA"]) / "gpsd-conformance"
    return [
        line
        for log in sorted(folder.glob("*.log"))
        for line in log.read_bytes().splitlines()
        if line.startswith((b"$", b"!"))
    ]


class Listener:
    """A core, and what must hold of what it says."""

    def __init__(self) -> None:
        self.core = GpsIngestCore()
        self.last_ns = 0
        self.messages = 0

    def hear(self, given: Sentence | Tick) -> None:
        """Give the core something and check what comes of it."""
        for message in self.core.handle(given, "fuzz"):
            self.messages += 1
            assert message.t_ns >= self.last_ns, "time went back"
            self.last_ns = message.t_ns
            assert decode(message.topic, encode(message)) == message


class Fuzzer:
    """Recorded lines and the damage that is done to them."""

    def __init__(self, seeds: list[bytes]) -> None:
        self._seeds = seeds
        self._splitter = SentenceSplitter()
        self._veteran = Listener()
        self._sentences = 0

    @property
    def core(self) -> GpsIngestCore:
        """The one that lives through it all."""
        return self._veteran.core

    @property
    def counts(self) -> tuple[int, int]:
        """Sentences in, messages out of the long-lived core."""
        return self._sentences, self._veteran.messages

    def run(self, choose: random.Random) -> None:
        """A round: recorded lines in their order from some place on, some of them damaged."""
        listeners = (self._veteran, Listener())
        received_ns = choose.choice((None, 0, 10**18, 2**62))
        for text in self._texts(choose):
            self._sentences += 1
            for listener in listeners:
                listener.hear(Sentence(received_ns, text))
        for listener in listeners:
            last_ns = listener.last_ns
            listener.hear(Tick(choose.choice((0, last_ns, last_ns + 10**9, 2**62))))

    def _texts(self, choose: random.Random) -> Iterator[str]:
        start = choose.randrange(len(self._seeds))
        damaged = choose.choice((0.0, 0.1, 0.5, 1.0))
        for line in self._seeds[start : start + ROUND]:
            chunk = damage(line, choose, self._seeds) if choose.random() < damaged else line
            for piece in pieces(chunk + b"\r\n", choose):
                yield from self._splitter.feed(piece)


def pieces(chunk: bytes, choose: random.Random) -> Iterator[bytes]:
    """A chunk as a link may cut it."""
    cut = choose.randrange(len(chunk) + 1)
    yield from (chunk[:cut], chunk[cut:])


def damage(line: bytes, choose: random.Random, seeds: list[bytes]) -> bytes:
    """A line with one to three faults."""
    for _ in range(choose.randint(1, 3)):
        line = choose.choice(FAULTS)(line, choose, seeds)
    return line


def _flip(line: bytes, choose: random.Random, seeds: list[bytes]) -> bytes:
    at = choose.randrange(len(line) + 1)
    return line[:at] + bytes([choose.randrange(256)]) + line[at + choose.randint(0, 1) :]


def _cut(line: bytes, choose: random.Random, seeds: list[bytes]) -> bytes:
    return line[: choose.randrange(len(line) + 1)]


def _splice(line: bytes, choose: random.Random, seeds: list[bytes]) -> bytes:
    return _cut(line, choose, seeds) + choose.choice(seeds)


def _noise(line: bytes, choose: random.Random, seeds: list[bytes]) -> bytes:
    at = choose.randrange(len(line) + 1)
    return line[:at] + choose.choice((*NOISE, choose.randbytes(40))) + line[at:]


def _field(line: bytes, choose: random.Random, seeds: list[bytes]) -> bytes:
    """Another field, from a list of awkward ones, and a checksum that vouches for it."""
    fields = line.lstrip(b"$!").partition(b"*")[0].split(b",")
    fields[choose.randrange(len(fields))] = choose.choice(FIELDS).encode("latin-1")
    return _checked(b",".join(fields))


def _digits(line: bytes, choose: random.Random, seeds: list[bytes]) -> bytes:
    """Other digits, and a checksum that vouches for them."""
    body = bytearray(line.lstrip(b"$!").partition(b"*")[0])
    for at, byte in enumerate(body):
        if chr(byte).isdigit() and choose.random() < 0.2:
            body[at] = ord(choose.choice("0123456789"))
    return _checked(bytes(body))


def _checked(body: bytes) -> bytes:
    return b"$%s*%02X" % (body, reduce(xor, body, 0))


Fault = Callable[[bytes, random.Random, list[bytes]], bytes]
FAULTS: tuple[Fault, ...] = (_flip, _cut, _splice, _noise, _field, _field, _digits, _digits)


if __name__ == "__main__":
    sys.exit(main())
