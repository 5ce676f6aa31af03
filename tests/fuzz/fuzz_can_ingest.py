"""Feeds can-ingest rubbish on several buses for some minutes: `fuzz_can_ingest.py --minutes 10`.

Frames of recorded buses (WAYLINE_DATA) get other identifiers, lengths, bytes and times; as many
are made up, most of them with identifiers that are mapped or that carry long messages. All of it
goes the way of a live frame: what python-can gives, a look-up, a core. One core of each bus lives
through it all, so that a leak shows; each round has a fresh one too. What must hold: no exception,
instants of a topic that never decrease, messages within the bounds of their fields, memory that
does not grow. Ends with 1 if something does not; the same seed runs the same rounds.
"""

import argparse
import logging
import math
import os
import random
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path

import can
import psutil

from wayline.can_log import CanLog
from wayline.codec import decode, encode
from wayline.drive import CanSource, Clock, SignalMapping, Vehicle
from wayline.drive_file import load_drive
from wayline.inputs import Flush, Frame, Tick
from wayline.messages import Message
from wayline_can_ingest.configured import load_mapping
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.frames import FrameReader
from wayline_can_ingest.j1939 import identifier_of
from wayline_can_ingest.mapping import Mapping
from wayline_can_ingest.wanted import TRANSPORT_PGNS, Wanted

log = logging.getLogger("fuzz")
ROUND = 400
"""Frames on each bus; a tick ends a round."""
SEEDS = 20_000
"""Recorded frames of each bus."""
WARM_ROUNDS = 200
"""Caches are full by then; memory is compared from there."""
GROWTH_MAX_KB = 20_000
START_NS = 1_700_000_000_000_000_000
LENGTHS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8, 9, 12, 39, 64, 65, 200)
BYTES = (0x00, 0xFF, 0xFE, 0xFB, 0x7F, 0x80, 0x01)
STAMPS_S = (math.nan, math.inf, -math.inf, -1.0, 0.0, 1e18, 1e300)
STEPS_S = (0.0, 1e-4, 1e-3, 0.01, 0.2, 3.0, 1e4, -1.0, -1e6)


def main() -> int:
    """Run rounds until the time is over."""
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    buses = recorded_buses(Path(os.environ["WAYLINE_DATA"]))
    end_s = time.monotonic() + options.minutes * 60.0
    rounds, warm_kb = 0, 0
    while time.monotonic() < end_s:
        try:
            for bus in buses:
                bus.run(random.Random(options.seed + rounds))
        except Exception:
            log.exception("round %d failed", rounds)
            return 1
        rounds += 1
        if rounds == WARM_ROUNDS:
            warm_kb = held_kb()
    frames, messages = (sum(each) for each in zip(*(bus.counts for bus in buses), strict=True))
    log.info("%d rounds, %d frames, %d messages, 0 exceptions", rounds, frames, messages)
    log.info("memory: %d kB after %d rounds, %d kB at the end", warm_kb, WARM_ROUNDS, held_kb())
    for bus in buses:
        log.info("%s: %d frames, %d messages, %s", bus.name, *bus.counts, bus.faults)
    return int(rounds > WARM_ROUNDS and held_kb() - warm_kb > GROWTH_MAX_KB)


def held_kb() -> int:
    """Memory that this process holds; the most it has held was while it read the recordings."""
    return int(psutil.Process().memory_info().rss) // 1024


class Listener:
    """What hears a bus as the service does, and what must hold of what it says."""

    def __init__(self, source: CanSource, mapping: Mapping, vehicle: Vehicle) -> None:
        self.core = CanIngestCore(source, mapping, vehicle)
        self.reader = FrameReader("can0")
        self._wanted = Wanted(mapping)
        self._last_ns: Counter[str] = Counter()
        self.messages = 0

    def hear(self, given: can.Message, received_ns: int) -> None:
        """Take what an interface gives."""
        frame = self.reader.frame(given, received_ns)
        if frame is not None and self._wanted.has(frame):
            self.handle(frame)

    def handle(self, given: Frame | Tick | Flush) -> None:
        """Give the core something and check what comes of it."""
        for message in self.core.handle(given, "fuzz"):
            self.messages += 1
            self._check(message)

    def _check(self, message: Message) -> None:
        assert message.t_ns >= self._last_ns[message.topic], "time went back"
        self._last_ns[message.topic] = message.t_ns
        assert decode(message.topic, encode(message)) == message


class Bus:
    """A mapping, recorded frames and the damage that is done to them."""

    def __init__(self, name: str, source: CanSource, vehicle: Vehicle, seeds: list[Frame]) -> None:
        self.name = name
        self._parts = (source, load_mapping(source, vehicle, name), vehicle)
        self._seeds = seeds
        self._mapped = [*_identifiers(self._parts[1])]
        self._veteran = Listener(*self._parts)
        self._frames = 0

    @property
    def counts(self) -> tuple[int, int]:
        """Frames in, messages out of the long-lived core."""
        return self._frames, self._veteran.messages

    @property
    def faults(self) -> dict[str, int]:
        """What the long-lived core and its reader counted."""
        return {**self._veteran.reader.faults, "bad input": self._veteran.core.bad_input}

    def run(self, choose: random.Random) -> None:
        """A round: recorded frames in their order from some place on, and others between them."""
        listeners = (self._veteran, Listener(*self._parts))
        start, received_ns = choose.randrange(len(self._seeds)), START_NS
        for number in range(ROUND):
            seed = self._seeds[(start + number) % len(self._seeds)]
            received_ns += choose.randrange(2_000_000)
            given = self._made_up(choose) if choose.random() < 0.5 else self._damaged(seed, choose)
            given.timestamp += received_ns * 1e-9
            self._frames += 1
            for listener in listeners:
                listener.hear(given, received_ns)
        for listener in listeners:
            listener.handle(choose.choice((Tick, Flush))(choose.choice((0, received_ns, 2**62))))

    def _damaged(self, seed: Frame, choose: random.Random) -> can.Message:
        given = message(seed.arbitration_id, seed.extended, seed.data)
        for _ in range(choose.choice((0, 0, 1, 3))):
            choose.choice(FAULTS)(given, choose)
        return given

    def _made_up(self, choose: random.Random) -> can.Message:
        number, extended = choose.choice(self._mapped)
        if choose.random() < 0.3:
            extended = choose.random() < 0.5
            number = choose.randrange(0x2000_0000 if extended else 0x800)
        given = message(number, extended, b"")
        _fill(given, choose)
        return given


def message(number: int, extended: bool, data: bytes) -> can.Message:
    """As an interface gives it, unchecked; its time is what it is off."""
    return can.Message(arbitration_id=number, is_extended_id=extended, data=data, dlc=len(data))


def _identifiers(mapping: Mapping) -> Iterator[tuple[int, bool]]:
    for key in mapping.plans:
        number = identifier_of(key.number, 0x17, 0xFF) if key.is_pgn else key.number
        yield number, key.extended
    if mapping.pgns:
        yield from ((identifier_of(pgn, 0, 0xFF), True) for pgn in TRANSPORT_PGNS)


def _identifier(given: can.Message, choose: random.Random) -> None:
    given.arbitration_id ^= 1 << choose.randrange(32)


def _format(given: can.Message, choose: random.Random) -> None:
    given.is_extended_id = not given.is_extended_id


def _kind(given: can.Message, choose: random.Random) -> None:
    given.is_error_frame, given.is_remote_frame = choose.choice(((True, False), (False, True)))


def _length(given: can.Message, choose: random.Random) -> None:
    length = choose.choice(LENGTHS)
    given.data = (given.data * 200 if given.data else bytearray(200))[:length]


def _byte(given: can.Message, choose: random.Random) -> None:
    if given.data:
        given.data[choose.randrange(len(given.data))] = choose.choice(BYTES)


def _fill(given: can.Message, choose: random.Random) -> None:
    """Noise, or sentinels; in transport frames mostly what announces something."""
    length = choose.choice(LENGTHS)
    values = choose.choice((choose.randbytes(length), bytes(choose.choices(BYTES, k=length))))
    if choose.random() < 0.3:
        values = bytes([choose.choice((16, 17, 19, 32, 255, 1, 2, 3)), *values[1:]])
    if choose.random() < 0.3 and length >= 8:
        values = values[:1] + bytes([choose.choice((9, 14, 39)), 0, 2, 0xFF, 0xE3, 0xFE, 0])
    given.data = bytearray(values)


def _stamp(given: can.Message, choose: random.Random) -> None:
    given.timestamp = choose.choice((choose.choice(STAMPS_S), choose.choice(STEPS_S)))


Fault = Callable[[can.Message, random.Random], None]
FAULTS: tuple[Fault, ...] = (_identifier, _format, _kind, _length, _byte, _byte, _fill, _stamp)
"""What a faulty adapter does."""


def recorded_buses(data: Path) -> list[Bus]:
    """A car by OBD-II, a car's own bus, trucks by the profile, and a bus with a clock signal."""
    css, comma = load_drive(data / "css-164"), load_drive(data / "comma-seg40-can")
    trucks = [str(path) for path in sorted((data / "j1939-stationary").glob("*.mf4"))]
    truck = CanSource(path=tuple(trucks))
    clocked = CanSource(
        path=css.can[0].path,
        dbc=css.can[0].dbc,
        signals={
            "gyro.yaw_rate_degps": SignalMapping(message="gnss_imu", signal="AngularRateX"),
            "odometer.distance_m": SignalMapping(message="gnss_odo", signal="DistanceTrip"),
        },
        clock=Clock(message="gnss_time", signal="Epoch"),
    )
    every = Vehicle(profile=("j1939-truck", "canmod-gps", "obd2"), engine_reference_torque_nm=1.0)
    return [
        Bus("css-164", css.can[0], css.vehicle, frames_of(css.can[0])),
        Bus("comma-seg40", comma.can[0], comma.vehicle, frames_of(comma.can[0])),
        Bus(
            "all profiles", truck, every, [f for t in trucks for f in frames_of(CanSource(path=t))]
        ),
        Bus("with a clock", clocked, Vehicle(), frames_of(clocked)),
    ]


def frames_of(source: CanSource) -> list[Frame]:
    """The first frames of a recording."""
    return list(islice(CanLog([Path(path) for path in source.paths]), SEEDS))


if __name__ == "__main__":
    sys.exit(main())
