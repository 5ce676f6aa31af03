"""`bench raw`: what raw measurements cost beside bare pyubx2 and bare filterpy."""

import gc
from collections.abc import Sequence
from functools import partial
from operator import attrgetter

import psutil
from pyubx2 import UBXReader

from wayline.codec import encode
from wayline_bench.made_up_sky import TOE_S, epoch, navigation, sky
from wayline_bench.raw_epoch import epoch_row
from wayline_bench.rounds import Say, Work, in_turns
from wayline_bench.row import Row, compared
from wayline_gps_ingest.raw.broadcast import Broadcast
from wayline_gps_ingest.raw.core import RawIngestCore
from wayline_gps_ingest.raw.ephemerides import Placing
from wayline_gps_ingest.raw.ubx import UbxReceiver

ROUNDS = 9
EPOCHS = 200
SATELLITES = 12
START_S = TOE_S + 3_800.0
"""When more than twelve are in the sky."""
SKY = sky(START_S, mask_deg=0.0)[:SATELLITES]
READING_BAR = 1.5
FEW, MANY = 200, 2_000
"""Epochs read before the memory is looked at first, and until it is again."""
MEMORY_BAR = 1.02
READ = ("prMes", "doMes", "gnssId", "svId", "sigId", "freqId", "cno", "prStd", "doStd", "prValid")
"""What gps_raw is made of, by pyubx2's names."""


def bench(say: Say) -> list[Row]:
    """Every row. Needs no recorded data."""
    messages = [epoch(SKY, START_S + number) for number in range(EPOCHS)]
    works: dict[str, Work] = {"ours": partial(told, messages), "bare": partial(parsed, messages)}
    spent_s = in_turns(works, ROUNDS, say)
    us = {work: [each * 1e6 / EPOCHS for each in rounds] for work, rounds in spent_s.items()}
    reading = compared(
        f"RXM-RAWX of {SATELLITES} satellites to gps_raw, their places in it",
        us["ours"],
        us["bare"],
        "pyubx2 parsed, the same fields read",
        unit="us an epoch",
        bar=READING_BAR,
    )
    return [reading, memory_row(messages, say), epoch_row(say)]


def receiver() -> UbxReceiver:
    """One that has heard of all its satellites."""
    ephemerides = Broadcast()
    made = UbxReceiver(Placing(ephemerides), ephemerides)
    made.feed(navigation(SKY))
    return made


def told(messages: Sequence[bytes]) -> None:
    """Bytes to encoded messages, as they go on the bus."""
    heard, core = receiver(), RawIngestCore(air=Broadcast())
    for message in messages:
        for each in heard.feed(message):
            for raw in core.handle(each, "bench"):
                encode(raw)


def parsed(messages: Sequence[bytes]) -> None:
    """What pyubx2 alone spends on the same bytes."""
    names = [f"{name}_{number:02d}" for number in range(1, SATELLITES + 1) for name in READ]
    read = attrgetter("week", "rcvTow", "numMeas", *names)
    for message in messages:
        read(UBXReader.parse(message))


def memory_row(messages: Sequence[bytes], say: Say) -> Row:
    """What a receiver's process holds after many epochs, beside after few."""
    heard, core = receiver(), RawIngestCore(air=Broadcast())
    held_mb: list[float] = []
    for number in range(MANY + 1):
        # the same few seconds of the sky again: only what is kept of epochs may grow
        for each in heard.feed(messages[number % EPOCHS]):
            for raw in core.handle(each, "bench"):
                encode(raw)
        if number in {FEW, MANY}:
            gc.collect()
            held_mb.append(psutil.Process().memory_info().rss / 1e6)
            say(f"{number} epochs")
    return compared(
        f"memory after {MANY:,} epochs",
        held_mb[1:],
        held_mb[:1],
        f"after {FEW}",
        unit="MB",
        bar=MEMORY_BAR,
    )
