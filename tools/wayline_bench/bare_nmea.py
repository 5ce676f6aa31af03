"""What gps-ingest is measured against: pynmea2 and nothing else, and a parser that does less."""

from collections.abc import Callable, Iterable
from functools import reduce
from operator import attrgetter, xor

import pynmea2

from wayline_gps_ingest.parsing import Fault, Parsed

PLACE = ("latitude", "longitude")
FIX_FIELDS = {
    "RMC": ("timestamp", "status", *PLACE, "spd_over_grnd", "true_course", "datestamp"),
    "GGA": (
        *("timestamp", *PLACE, "gps_qual", "num_sats", "horizontal_dil"),
        *("altitude", "geo_sep"),
    ),
    "GSA": (
        *("mode_fix_type", "pdop", "hdop", "vdop"),
        *(f"sv_id{slot:02d}" for slot in range(1, 13)),
    ),
    "GST": ("timestamp", "std_dev_latitude", "std_dev_longitude", "std_dev_altitude"),
    "VTG": ("true_track", "spd_over_grnd_kts"),
}
"""What a `gps_fix` is made of, by pynmea2's names."""
SKY_FIELDS = {
    "GSV": tuple(
        f"{name}_{slot}"
        for slot in range(1, 5)
        for name in ("sv_prn_num", "elevation_deg", "azimuth", "snr")
    )
}
"""What a `gps_sky` is made of besides the satellites in use."""

Reader = Callable[[object], object]
FIX_READERS: dict[str, Reader] = {kind: attrgetter(*names) for kind, names in FIX_FIELDS.items()}
ALL_READERS: dict[str, Reader] = {
    kind: attrgetter(*names) for kind, names in (FIX_FIELDS | SKY_FIELDS).items()
}


def parse_and_read(lines: Iterable[str], readers: dict[str, Reader]) -> None:
    """Every line by `pynmea2.parse`, and the fields of its kind as attributes."""
    for line in lines:
        sentence = pynmea2.parse(line)
        if read := readers.get(sentence.sentence_type):
            read(sentence)


def split_parse(text: str) -> Parsed | Fault | None:
    """As little as a parser in Python can do for a good sentence: checksum and split.

    An experiment: what gps-ingest would cost with a faster parser. It refuses nothing else.
    """
    body, _, told = text[1:].partition("*")
    if reduce(xor, body.encode("latin-1"), 0) != int(told[:2], 16):
        return "checksum"
    address, *fields = body.split(",")
    return Parsed(address[:2], address[2:], fields, checked=True)
