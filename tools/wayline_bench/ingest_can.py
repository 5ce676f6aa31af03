"""Recorded buses: what can-ingest costs a frame beside bare cantools."""

import os
import sys
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import cycle, islice
from pathlib import Path
from typing import NamedTuple

import msgspec
from cantools.database.can import Message as DbcMessage
from cantools.database.errors import DecodeError

from wayline.can_log import CanLog
from wayline.codec import encode
from wayline.drive import CanSource, Drive
from wayline.drive_file import load_drive
from wayline.inputs import Frame
from wayline_bench.rounds import Say, Work, in_turns
from wayline_bench.row import Row, compared
from wayline_can_ingest.configured import load_mapping
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.dbc import load_databases
from wayline_can_ingest.mapping import Mapping

ROUNDS = 15
DRIVES = ("css-164", "comma-seg40-can")
FRAMES = 10_000
"""Of each kind a round."""
MAPPED_BAR = 1.5
UNMAPPED_BAR = 0.1
UNIT = "us a frame"
YARDSTICK = "cantools"


def frame_rows(say: Say) -> list[Row]:
    """Every recorded bus. Reads the drives in the folder that `WAYLINE_DATA` names."""
    rows: list[Row] = []
    for name in DRIVES:
        folder = Path(os.environ.get("WAYLINE_DATA", "")) / name
        if folder.is_dir():
            rows += bus_rows(Bus.of(load_drive(folder)), f"{name}, recorded frames", say)
        else:
            reason = f"no {name} in the folder that WAYLINE_DATA names"
            print(f"{name} is left out: {reason}", file=sys.stderr)
    return rows


class Bus(NamedTuple):
    """A drive's first bus, read whole beforehand."""

    drive: Drive
    mapping: Mapping
    mapped: Sequence[Frame]
    unmapped: Sequence[Frame]
    databases: dict[tuple[int, bool], DbcMessage]

    @classmethod
    def of(cls, drive: Drive) -> "Bus":
        """Frames that the drive maps, in their order, and others."""
        source = drive.can[0]
        mapping = load_mapping(source, drive.vehicle, drive.drive.vehicle_id)
        frames = list(CanLog([Path(path) for path in source.paths]))
        databases = {
            (message.frame_id, message.is_extended_frame): message
            for database in load_databases([Path(path) for path in source.dbc])
            for message in database.messages
        }
        mapped = [each for each in frames if is_mapped(mapping, each)]
        unmapped = [each for each in frames if not is_mapped(mapping, each)]
        return cls(
            drive,
            mapping,
            side_by_side(mapped[:FRAMES]),
            side_by_side(list(islice(cycle(unmapped), FRAMES))),
            databases,
        )

    def core(self) -> CanIngestCore:
        """A fresh core on the mapping that is already compiled."""
        source: CanSource = self.drive.can[0]
        return CanIngestCore(source, self.mapping, self.drive.vehicle)


def side_by_side(frames: list[Frame]) -> list[Frame]:
    """Copies in one place of the memory: a frame that has just come is in the caches."""
    return msgspec.msgpack.decode(msgspec.msgpack.encode(frames), type=list[Frame])


def is_mapped(mapping: Mapping, frame: Frame) -> bool:
    """Whether anything of a frame is asked for."""
    return bool(mapping.find(frame.arbitration_id, frame.extended))


def bus_rows(bus: Bus, name: str, say: Say) -> list[Row]:
    """Frame to messages beside cantools alone, and frames that nobody asks for."""
    works: dict[str, Work] = {
        "messages": lambda: translate(bus.core(), bus.mapped),
        "encoded": lambda: publish(bus.core(), bus.mapped),
        "unmapped": lambda: translate(bus.core(), bus.unmapped),
        "signals": partial(read_signals, bus.mapping, bus.mapped),
        "cantools": partial(decode, bus.databases, bus.mapped),
    }
    spent_s = in_turns(works, ROUNDS, lambda progress: say(f"{name}: {progress}"))
    counts = {work: len(bus.unmapped if work == "unmapped" else bus.mapped) for work in works}
    us = {work: [each * 1e6 / counts[work] for each in spent_s[work]] for work in works}

    def row(what: str, ours: str, other: str, yardstick: str, bar: float | None = None) -> Row:
        title = f"{name}: {what}"
        return compared(title, us[ours], us[other], yardstick, unit=UNIT, bar=bar)

    return [
        row("mapped frame to messages", "messages", "cantools", YARDSTICK, MAPPED_BAR),
        row("mapped frame to encoded messages", "encoded", "cantools", YARDSTICK),
        row("mapped signals of a frame alone", "signals", "cantools", YARDSTICK),
        row("unmapped frame", "unmapped", "messages", "mapped frame", UNMAPPED_BAR),
    ]


def translate(core: CanIngestCore, frames: Sequence[Frame]) -> None:
    """Each frame through a core."""
    for frame in frames:
        core.handle(frame, "bench")


def publish(core: CanIngestCore, frames: Sequence[Frame]) -> None:
    """Frames to messages, encoded as they go on the bus."""
    for frame in frames:
        for message in core.handle(frame, "bench"):
            encode(message)


def read_signals(mapping: Mapping, frames: Sequence[Frame]) -> None:
    """The mapped signals of each frame, and nothing made of them."""
    for frame in frames:
        for plan in mapping.find(frame.arbitration_id, frame.extended):
            plan.decode(frame.data)


def decode(databases: dict[tuple[int, bool], DbcMessage], frames: Sequence[Frame]) -> None:
    """Each frame by its message's `decode`, without words for numbers, which nobody reads."""
    for _ in decoded(databases, frames):
        pass


def decoded(
    databases: dict[tuple[int, bool], DbcMessage], frames: Sequence[Frame]
) -> Iterator[object]:
    """What cantools says; nothing for a multiplexer value that the database does not list."""
    for frame in frames:
        message = databases[frame.arbitration_id, frame.extended]
        try:
            yield message.decode_simple(frame.data, decode_choices=False, allow_truncated=True)
        except DecodeError:
            continue
