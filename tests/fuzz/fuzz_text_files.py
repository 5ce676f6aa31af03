"""Feeds every reader of text damaged files for some minutes: `fuzz_text_files.py --minutes 10`.

Small files of each kind (NMEA, gpsd's reports, AVL and route CSV, GPX, GeoJSON, GTFS) are cut,
spliced, flipped, zeroed and shuffled, get other fields, other encodings, and are packed. All of it
goes the way of a user's file: a drive's recordings, or `wayline route import`. What must hold: an
InputError or a result, each file within seconds, messages within the bounds of their
fields and in order, memory that does not grow. Ends with 1 if something does not; the same seed
runs the same rounds.
"""

import argparse
import gzip
import io
import logging
import random
import resource
import signal
import sys
import tempfile
import time
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import reduce
from operator import xor
from pathlib import Path
from types import FrameType

from wayline.codec import decode, encode
from wayline.drive import AvlColumns, AvlSource, Drive, DriveInfo, NmeaSource
from wayline.errors import InputError
from wayline.received import Sources
from wayline_cli.route_import import Wishes, import_route
from wayline_gps_ingest.recorded import recordings

log = logging.getLogger("fuzz")
FILE_MAX_S = 5.0
"""For files of a few hundred bytes: longer is a hang."""
WARM_FILES = 5_000
"""Caches are full by then; memory is compared from there."""
GROWTH_MAX_KB = 20_000

SENTENCES = (
    b"$GPGGA,120000.00,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,",
    b"$GPRMC,120000.00,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
    b"$GPGSA,A,3,04,05,,09,12,,,24,,,,,2.5,1.3,2.1",
    b"1700000000.25 $GPZDA,120000.02,23,03,1994,00,00",
    b"$GPGSV,1,1,01,07,46,259,26",
    b"$GPGST,120001.00,5.0,,,,3.0,4.0,7.5",
    b"$GPGLL,4807.038,N,01131.000,E,120001.00,A,A",
    b"$GPRMC,120001.00,A,4807.039,N,01131.000,E,022.4,084.4,230394,003.1,W",
)
NMEA = b"".join(
    b"%s*%02X\r\n" % (sentence, reduce(xor, sentence.partition(b"$")[2])) for sentence in SENTENCES
)
GPSD = b"""{"class":"VERSION","release":"3.17","proto_major":3,"proto_minor":12}
{"class":"TPV","device":"a","mode":3,"time":"2019-03-10T08:16:24.000Z","lat":48.1,"lon":11.5,"alt":449.5,"speed":0.041,"track":51.15}
{"class":"SKY","device":"a","hdop":1.1,"pdop":1.8,"nSat":2,"uSat":1,"satellites":[{"PRN":17,"el":72.0,"az":360.0,"ss":32.0,"used":true}]}
{"class":"GST","device":"a","lat":3.0,"lon":4.0,"alt":6.5}
{"class":"TPV","device":"a","mode":3,"time":1552205785.5,"lat":48.1,"lon":11.5,"altHAE":496.0,"geoidSep":46.0}
"""
AVL = b"""time;lat;lon;heading;speed
22.11.2026 10:00:00;48,1000;11,5000;102;4,5
2026-11-22T10:00:30Z;48,1010;11,5000;;
1795341660250;48,1020;11,5000;359,9;0
"""
CSV = b"""sep=,
Time,GPS Latitude,GPS Longitude,Speed (km/h),shape_id,shape_pt_sequence
2024-01-01T10:00:00Z,48.1,11.5,0,A,1
2024-01-01T10:00:01Z,48.101,11.5,14.4,A,2
2024-01-01T10:00:02Z,48.102,11.5,28.8,A,3
"""
GPX = b"""<?xml version="1.0" encoding="UTF-8"?>
<gpx version="1.1" creator="t" xmlns="http://www.topografix.com/GPX/1/1"><trk><name>R</name><trkseg>
<trkpt lat="48.1" lon="11.5"><ele>500</ele><time>2026-01-01T10:00:00Z</time></trkpt>
<trkpt lat="48.101" lon="11.5"><ele>501</ele><time>2026-01-01T10:00:10Z</time></trkpt>
</trkseg></trk></gpx>
"""
GEOJSON = b"""{"type":"FeatureCollection","features":[
{"type":"Feature","id":7,"properties":{"name":"Ring","loop":false,"speeds_mps":[5,6]},
"geometry":{"type":"LineString","coordinates":[[11.5,48.1],[11.5,48.101,500],[11.5,48.102]]}},
{"type":"Feature","properties":{"stop_id":3,"dwell_s":20},
"geometry":{"type":"Point","coordinates":[11.5,48.101]}}]}
"""
TABLES = {
    "trips.txt": b"route_id,trip_id,shape_id\n7,t1,\n",
    "stops.txt": b"stop_id,stop_name,stop_lat,stop_lon\na,Gate,60.0,20.0\nb,Mill,60.01,20.0\n",
    "stop_times.txt": b"trip_id,stop_id,arrival_time,departure_time,stop_sequence\n"
    b"t1,a,10:00:00,10:00:30,1\nt1,b,10:01:30,10:01:30,2\n",
}
TOKENS = (
    b"", b"0", b"-1", b"1e309", b"nan", b"9" * 400, b"\x00" * 8, b"\xff\xfe", b"\xef\xbb\xbf", b'"',
    b"[" * 3000, b"<a>" * 3000, b"\n", b",", b";", b"null", b"true", b"{}", b"\xe9", b"&#0;",
    b"*00", b"180", b"-90.0", b"0.0", b"2026-02-30T25:61:61Z", b"9999-12-31T23:59:59Z", b"99:99:99",
)  # fmt: skip


def zipped(choose: random.Random | None = None) -> bytes:
    """A feed, one of its tables damaged."""
    packed = io.BytesIO()
    hurt = choose.choice(sorted(TABLES)) if choose else ""
    with zipfile.ZipFile(packed, "w") as archive:
        for name, table in TABLES.items():
            archive.writestr(name, damaged(table, choose) if choose and name == hurt else table)
    return packed.getvalue()


def read_as_nmea(path: Path) -> None:
    """A `[[nmea]]` of a drive."""
    info = DriveInfo(vehicle_id="t")
    read_drive(Drive(drive=info, nmea=(NmeaSource(path=str(path)),)))


def read_as_avl(path: Path) -> None:
    """An `[[avl]]` of a drive."""
    columns = AvlColumns(
        time="time", lat_deg="lat", lon_deg="lon", heading_deg="heading", speed_mps="speed"
    )
    source = AvlSource(path=str(path), columns=columns)
    read_drive(Drive(drive=DriveInfo(vehicle_id="t"), avl=(source,)))


def read_drive(drive: Drive) -> None:
    """Every message of its sources; one of which nothing comes is refused."""
    sources, last_ns = Sources(recordings(drive, "fuzz")), 0
    for received in sources:
        message = received.message
        assert message.t_ns >= last_ns, "time went back"
        last_ns = message.t_ns
        assert decode(message.topic, encode(message)) == message
    sources.check()
    assert min(sources.bad_input.values()) >= 0


def read_as_route(path: Path) -> None:
    """`wayline route import`"""
    assert import_route(path, Wishes()).length_m > 0.0


Read = Callable[[Path], None]
SEEDS: tuple[tuple[bytes, Read], ...] = (
    (NMEA, read_as_nmea),
    (GPSD, read_as_nmea),
    (AVL, read_as_avl),
    (CSV, read_as_route),
    (GPX, read_as_route),
    (GEOJSON, read_as_route),
    (zipped(), read_as_route),
)


@contextmanager
def bounded() -> Iterator[None]:
    """Raises TimeoutError in a block that hangs."""

    def expire(number: int, frame: FrameType | None) -> None:
        raise TimeoutError("a file took too long")

    before = signal.signal(signal.SIGALRM, expire)
    signal.setitimer(signal.ITIMER_REAL, FILE_MAX_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def outcome(content: bytes, read: Read, path: Path) -> str:
    """What came of a file: `read`, or `refused`; anything else raises."""
    path.write_bytes(content)
    try:
        with bounded():
            read(path)
    except InputError:
        return "refused"
    return "read"


def damaged(content: bytes, choose: random.Random) -> bytes:
    """A file with one to three faults."""
    for _ in range(choose.randint(1, 3)):
        content = choose.choice(FAULTS)(content, choose)
    return content


def _flip(content: bytes, choose: random.Random) -> bytes:
    at = choose.randrange(len(content) + 1)
    return content[:at] + bytes([choose.randrange(256)]) + content[at + choose.randint(0, 1) :]


def _cut(content: bytes, choose: random.Random) -> bytes:
    return content[: choose.randrange(len(content) + 1)]


def _zero(content: bytes, choose: random.Random) -> bytes:
    at = choose.randrange(len(content) + 1) // 8 * 8
    return content[:at] + bytes(8) + content[at + 8 :]


def _splice(content: bytes, choose: random.Random) -> bytes:
    other = choose.choice(SEEDS)[0]
    return _cut(content, choose) + other[choose.randrange(len(other) + 1) :]


def _token(content: bytes, choose: random.Random) -> bytes:
    start = choose.randrange(len(content) + 1)
    return content[:start] + choose.choice(TOKENS) + content[start + choose.randrange(6) :]


def _digits(content: bytes, choose: random.Random) -> bytes:
    changed = bytearray(content)
    for at, byte in enumerate(content):
        if 48 <= byte < 58 and choose.random() < 0.1:
            changed[at] = choose.choice(b"0123456789-.")
    return bytes(changed)


def _lines(content: bytes, choose: random.Random) -> bytes:
    lines = content.splitlines(keepends=True)
    return b"".join(choose.choices(lines, k=choose.randrange(2 * len(lines) + 1))) if lines else b""


def _encoded(content: bytes, choose: random.Random) -> bytes:
    return content.decode("latin-1").encode(choose.choice(("utf-16", "utf-16-be", "utf-8-sig")))


def _packed(content: bytes, choose: random.Random) -> bytes:
    return gzip.compress(content, mtime=0)


FAULTS = (_flip, _cut, _zero, _splice, _token, _token, _digits, _lines, _encoded, _packed)


def peak_kb() -> int:
    """Most memory that this process has held."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def run_file(number: int, path: Path) -> str:
    """What came of one damaged file; the same number makes the same file."""
    choose = random.Random(number)
    content, read = choose.choice(SEEDS)
    if choose.random() < 0.1:
        content, read = zipped(choose), read_as_route
    return outcome(damaged(content, choose), read, path)


def main() -> int:
    """Run files until the time is over."""
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    end_s = time.monotonic() + options.minutes * 60.0
    outcomes: Counter[str] = Counter()
    number, warm_kb = options.seed, 0
    with tempfile.TemporaryDirectory() as folder:
        while time.monotonic() < end_s:
            try:
                outcomes[run_file(number, Path(folder) / "file")] += 1
            except Exception:
                log.exception("file %d failed", number)
                return 1
            number += 1
            if number - options.seed == WARM_FILES:
                warm_kb = peak_kb()
    log.info("%d files, 0 exceptions: %s", outcomes.total(), dict(outcomes))
    log.info("memory: %d kB after %d files, %d kB at the end", warm_kb, WARM_FILES, peak_kb())
    return int(bool(warm_kb) and peak_kb() - warm_kb > GROWTH_MAX_KB)


if __name__ == "__main__":
    sys.exit(main())
