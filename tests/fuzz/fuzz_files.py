"""Reads damaged files of every format for some minutes: `fuzz_files.py --minutes 10`.

Small files of every format that a drive may name are cut, zeroed, doubled and changed, plain and
packed, and go the way of a user's file: a drive names them, and the drive's messages are read. What
must hold: no exception but a refusal in one line, each file within its time, messages within the
bounds of their fields, memory that does not grow. Ends with 1 if something does not; the same seed
damages the same way.
"""

import argparse
import gzip
import logging
import random
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import psutil

from can_files import DBC, FORMATS, drive_of, recording
from unit.gps_ingest.raw.rinex_text import navigation_file, observations
from wayline.codec import decode, encode
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline_bench import made_up_sky
from wayline_replay.stream import DriveStream

log = logging.getLogger("fuzz")
SLOW = "mf4"
"""Its reader is a process of its own."""
SLOW_EVERY = 200
"""Of so many files one is of the slow format."""
TIME_MAX_S, SLOW_MAX_S = 10, 120
WARM_FILES = 300
"""Caches are full by then; memory is compared from there."""
GROWTH_MAX_KB = 20_000
NMEA = "".join(
    f"$GPGGA,1359{second:02}.00,4800.{second:02}000,N,01131.00000,E,1,08,1.0,500.0,M,47.0,M,,\n"
    f"$GPRMC,1359{second:02}.00,A,4800.{second:02}000,N,01131.00000,E,27.0,0.0,160420,,,A\n"
    for second in range(8)
).encode()
AVL = b"time,lat,lon\n" + b"".join(
    b"2020-04-16 13:59:%02d,48.%04d,11.5\n" % (second, second) for second in range(8)
)
SYM = b"""FormatVersion=6.0 // PCAN Symbol Editor
Title="v"

{SIGNALS}
Sig=Speed unsigned 16 /u:km/h /f:0.01

{SENDRECEIVE}

[SPD]
ID=123h
Len=8
Sig=Speed 0
"""
RAW = b"time,sat,range,x,y,z\n" + b"".join(
    b"%d,G%02d,%d,14567933.9,2809850.9,21875628.1\n" % (1587045541 + second, prn, 20000000 + prn)
    for second in range(8)
    for prn in range(1, 6)
)
RAW_TABLE = (
    'columns = { time = "time", prn = "sat", pseudorange_m = "range", '
    'x_m = "x", y_m = "y", z_m = "z" }\n'
)
RAW_SKY = made_up_sky.sky(made_up_sky.TOE_S + 300.0)
RINEX_NAV = navigation_file(each.orbit for each in RAW_SKY)
RINEX = observations(
    (
        5,
        float(second),
        [
            (f"G{prn:02d}", made_up_sky.signal(seen, made_up_sky.TOE_S + 300.0 + second))
            for prn, seen in ((each.orbit.prn, each.orbit) for each in RAW_SKY)
        ],
    )
    for second in range(8)
)
AVL_TABLE = 'columns = { time = "time", lat_deg = "lat", lon_deg = "lon" }\n'


class Kind:
    """A format: its whole file, and the drive that names a damaged one."""

    def __init__(self, name: str, data: bytes, write: Callable[[Path, bytes], None]) -> None:
        self.name = name
        self.data = data
        self.write = write


class TookTooLongError(Exception):
    """A file was not read within its time."""


def kinds(folder: Path) -> list[Kind]:
    """Every format, the slow one last."""
    made = []
    for kind in FORMATS:
        path = recording(kind, folder, count=20)
        made.append(Kind(kind, path.read_bytes(), _can_writer(path.name)))
    made.append(Kind("nmea", NMEA, _source_writer("[[nmea]]", "a.nmea", "")))
    made.append(Kind("avl", AVL, _source_writer("[[avl]]", "a.csv", AVL_TABLE)))
    made += _raw_kinds()
    made.append(Kind("dbc", DBC.encode(), _database_writer("v.dbc")))
    made.append(Kind("sym", SYM, _database_writer("v.sym")))
    return made


def _raw_kinds() -> list[Kind]:
    """Raw measurements: tables, u-blox, RINEX, and the navigation file beside that."""
    rinex = _source_writer("[[raw]]", "a.obs", 'nav = ["brdc.nav"]\n')

    def write_nav(folder: Path, data: bytes) -> None:
        rinex(folder, RINEX.encode())
        (folder / "brdc.nav").write_bytes(data)

    def write_rinex(folder: Path, data: bytes) -> None:
        (folder / "brdc.nav").write_text(RINEX_NAV)
        rinex(folder, data)

    return [
        Kind("raw table", RAW, _source_writer("[[raw]]", "a.csv", RAW_TABLE)),
        Kind("ubx", made_up_sky.recording(8), _source_writer("[[raw]]", "a.ubx", "")),
        Kind("rinex", RINEX.encode(), write_rinex),
        Kind("rinex nav", RINEX_NAV.encode(), write_nav),
    ]


def _can_writer(name: str) -> Callable[[Path, bytes], None]:
    def write(folder: Path, data: bytes) -> None:
        path = folder / (f"{name}.gz" if data.startswith(b"\x1f\x8b") else name)
        path.write_bytes(data)
        drive_of(folder, path)

    return write


def _source_writer(table: str, name: str, keys: str) -> Callable[[Path, bytes], None]:
    def write(folder: Path, data: bytes) -> None:
        (folder / name).write_bytes(data)
        text = f'[drive]\nvehicle_id = "t"\n{table}\npath = "{name}"\n{keys}'
        (folder / "drive.toml").write_text(text, encoding="utf-8")

    return write


def _database_writer(name: str) -> Callable[[Path, bytes], None]:
    def write(folder: Path, data: bytes) -> None:
        path = recording("candump", folder)
        drive_of(folder, path)
        (folder / name).write_bytes(data)
        text = (folder / "drive.toml").read_text(encoding="utf-8")
        (folder / "drive.toml").write_text(text.replace("v.dbc", name), encoding="utf-8")

    return write


def damaged(data: bytes, choose: random.Random) -> bytes:
    """A file after a power loss, a bad disk, a torn download or an editor."""
    if choose.random() < 0.3:
        data = gzip.compress(data, mtime=0)
    for _ in range(choose.choice((1, 1, 2, 4))):
        data = choose.choice(DAMAGES)(data, choose)
    return gzip.compress(data, mtime=0) if choose.random() < 0.1 else data


def _cut(data: bytes, choose: random.Random) -> bytes:
    return data[: choose.randrange(len(data) + 1)]


def _headless(data: bytes, choose: random.Random) -> bytes:
    return data[choose.randrange(len(data) + 1) :]


def _zeroed(data: bytes, choose: random.Random) -> bytes:
    at, size = choose.randrange(len(data) + 1), choose.choice((8, 64, 512))
    return data[:at] + bytes(size) + data[at + size :]


def _changed(data: bytes, choose: random.Random) -> bytes:
    at = choose.randrange(len(data) + 1)
    return data[:at] + choose.randbytes(choose.choice((1, 1, 2, 4, 8))) + data[at + 1 :]


def _digit(data: bytes, choose: random.Random) -> bytes:
    places = [at for at, byte in enumerate(data) if chr(byte).isdigit()]
    if not places:
        return data
    at = choose.choice(places)
    return (
        data[:at] + choose.choice((b"0", b"9", b"-", b".", b"F", b"999999999999")) + data[at + 1 :]
    )


def _doubled(data: bytes, choose: random.Random) -> bytes:
    start, size = choose.randrange(len(data) + 1), choose.randrange(200)
    return data[: start + size] + data[start:]


def _numbers(data: bytes, choose: random.Random) -> bytes:
    """A size or a link of a binary format."""
    at = choose.randrange(max(len(data) - 8, 0) + 1) // 8 * 8
    number = choose.choice((0, 1, 8, at, 2**31 - 1, 2**32 - 1, 2**63 - 1, 2**64 - 1))
    return data[:at] + number.to_bytes(8, "little") + data[at + 8 :]


def _encoded(data: bytes, choose: random.Random) -> bytes:
    text = data.decode("latin-1")
    return text.encode(choose.choice(("utf-16", "utf-16-le", "utf-8-sig", "utf-32")))


Damage = Callable[[bytes, random.Random], bytes]
DAMAGES: tuple[Damage, ...] = (
    _cut, _cut, _headless, _zeroed, _zeroed, _changed, _changed, _digit, _doubled, _numbers,
    _encoded,
)  # fmt: skip


def read(folder: Path) -> str:
    """Read and check every message of the drive; tells whether it was refused."""
    try:
        for arrival in DriveStream(load_drive(folder), str(folder)):
            message = arrival.message
            if decode(message.topic, encode(message)) != message:
                raise AssertionError(message)
    except InputError as error:
        if not str(error).isprintable():
            raise AssertionError(str(error)) from error
        return "refused"
    return "read"


def _too_long(number: int, frame: FrameType | None) -> None:
    raise TookTooLongError


def main() -> int:
    """Damage files until the time is over."""
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    signal.signal(signal.SIGALRM, _too_long)
    end_s = time.monotonic() + options.minutes * 60.0
    outcomes: Counter[str] = Counter()
    files, warm_kb, slowest_s = 0, 0, 0.0
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        made = kinds(folder)
        while time.monotonic() < end_s:
            choose = random.Random(options.seed + files)
            quick = [kind for kind in made if kind.name != SLOW]
            kind = choose.choice(quick if files % SLOW_EVERY else made)
            if files % SLOW_EVERY == 0:
                kind = next(each for each in made if each.name == SLOW)
            data = damaged(kind.data, choose)
            kind.write(folder, data)
            signal.alarm(SLOW_MAX_S if kind.name == SLOW else TIME_MAX_S)
            began_s = time.monotonic()
            try:
                outcome = read(folder)
            except Exception:
                kept = Path(tempfile.gettempdir()) / f"fuzz-failed-{kind.name.replace(' ', '-')}"
                kept.write_bytes(data)
                log.exception("file %d of --seed %d failed; it is %s", files, options.seed, kept)
                return 1
            signal.alarm(0)
            if kind.name != SLOW:
                slowest_s = max(slowest_s, time.monotonic() - began_s)
            outcomes[f"{kind.name} {outcome}"] += 1
            files += 1
            if files == WARM_FILES:
                warm_kb = held_kb()
    log.info("%d files, 0 exceptions, slowest %.2f s", files, slowest_s)
    log.info("memory: %d kB after %d files, %d kB at the end", warm_kb, WARM_FILES, held_kb())
    log.info(", ".join(f"{outcome} {count}" for outcome, count in sorted(outcomes.items())))
    return int(files > WARM_FILES and held_kb() - warm_kb > GROWTH_MAX_KB)


def held_kb() -> int:
    """Memory that this process holds."""
    return int(psutil.Process().memory_info().rss) // 1024


if __name__ == "__main__":
    sys.exit(main())
