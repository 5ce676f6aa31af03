"""Small CAN recordings of every format that is read, made anew for each test."""

import gzip
from collections.abc import Callable
from pathlib import Path

import can

START_S = 1_587_045_541.0
"""16 April 2020, 13:59:01 UTC."""
COUNT = 6
DATA = bytes.fromhex("8813B80B12345678")
DBC = """VERSION ""
BU_: X
BO_ 291 SPD: 8 X
 SG_ Speed : 0|16@1+ (0.01,0) [0|655] "km/h" X
 SG_ Rpm : 16|16@1+ (1,0) [0|65535] "rpm" X
"""
SIGNALS = """[can.signals]
"odometer.speed_mps" = { message = "SPD", signal = "Speed", scale = 0.2777777777777778 }
"""


def frames(count: int = COUNT) -> list[can.Message]:
    """A frame every 0.1 s, standard and extended by turns."""
    return [
        can.Message(
            timestamp=START_S + number / 10,
            arbitration_id=0x18FEF100 if number % 2 else 0x123,
            is_extended_id=bool(number % 2),
            data=DATA,
            channel=0,
        )
        for number in range(count)
    ]


def written(path: Path, count: int = COUNT) -> None:
    """A recording by python-can's own writer for the name's suffix."""
    with can.Logger(path) as log:
        for message in frames(count):
            log(message)


def _busmaster(message: can.Message, number: int) -> str:
    kind = "x" if message.is_extended_id else "s"
    data = message.data.hex(" ").upper()
    return f"13:59:01:{number * 1000:04d} Rx 1 0x{message.arbitration_id:03X} {kind} 8 {data} "


def _screen(message: can.Message, number: int) -> str:
    identifier = f"{message.arbitration_id:0{8 if message.is_extended_id else 3}X}"
    return (
        f" ({START_S + number / 10:.6f})  can0  {identifier}   [8]  {message.data.hex(' ').upper()}"
    )


def _gvret(message: can.Message, number: int) -> str:
    data = message.data.hex(",").upper()
    extended = str(message.is_extended_id).lower()
    us = round(START_S * 1e6) + number * 100_000
    return f"{us},{message.arbitration_id:08X},{extended},Rx,0,8,{data},"


def _css(message: can.Message, number: int) -> str:
    time, extended = f"{START_S + number / 10:.6f}", int(message.is_extended_id)
    return f"{time};1;{message.arbitration_id:X};{extended};8;8;0;0;0;{message.data.hex()}"


def _cabana(message: can.Message, number: int) -> str:
    return f"{START_S + number / 10:.6f},0x{message.arbitration_id:x},0,0x{message.data.hex()}"


def _microchip(message: can.Message, number: int) -> str:
    data = "".join(f"0x{byte:02X};" for byte in message.data)
    return f"{166064 + number * 100};RX;0x{message.arbitration_id:08X};8;{data}"


def _crtd(message: can.Message, number: int) -> str:
    bits = 29 if message.is_extended_id else 11
    data = message.data.hex(" ").upper()
    return f"{START_S + number / 10:.6f} 1R{bits} {message.arbitration_id:X} {data}"


Line = Callable[[can.Message, int], str]
LINES: dict[str, tuple[str, str, Line]] = {
    "busmaster": (
        "a.log",
        "***BUSMASTER Ver 3.2.2***\n***START DATE AND TIME 16:4:2020 13:59:01:000***\n***HEX***\n",
        _busmaster,
    ),
    "candump screen": ("a.txt", "", _screen),
    "gvret": (
        "b.csv",
        "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n",
        _gvret,
    ),
    "css": (
        "c.csv",
        "TimestampEpoch;BusChannel;ID;IDE;DLC;DataLength;Dir;EDL;BRS;DataBytes\n",
        _css,
    ),
    "cabana": ("d.csv", "time,addr,bus,data\n", _cabana),
    "microchip": ("b.log", "Microchip Technology Inc.\nCAN BUS Analyzer\n", _microchip),
    "crtd": ("a.crtd", "", _crtd),
}
WRITTEN = {
    "candump": "e.log",
    "asc": "e.asc",
    "trc": "e.trc",
    "csv": "e.csv",
    "blf": "e.blf",
    "mf4": "e.mf4",
    "db": "e.db",
}
TEXTS = ("candump", "asc", "trc", "csv", *LINES)
"""Formats of one frame a line."""
FORMATS = (*WRITTEN, *LINES)


def recording(kind: str, folder: Path, count: int = COUNT, *, packed: bool = False) -> Path:
    """A recording of a format in a folder that is there."""
    if kind in WRITTEN:
        path = folder / WRITTEN[kind]
        written(path, count)
    else:
        name, header, line = LINES[kind]
        path = folder / name
        lines = (line(message, number) for number, message in enumerate(frames(count)))
        path.write_text(header + "".join(f"{each}\n" for each in lines), encoding="ascii")
    if packed:
        packed_path = path.with_name(f"{path.name}.gz")
        packed_path.write_bytes(gzip.compress(path.read_bytes(), mtime=0))
        return packed_path
    return path


def drive_of(folder: Path, *paths: Path, options: str = "", sources: str = "") -> Path:
    """A drive that names recordings, with the database of their speed."""
    (folder / "v.dbc").write_text(DBC, encoding="ascii")
    names = ", ".join(f'"{path}"' for path in paths)
    (folder / "drive.toml").write_text(
        f'[drive]\nvehicle_id = "t"\n{sources}[[can]]\npath = [{names}]\ndbc = ["v.dbc"]\n'
        f"{options}\n{SIGNALS}",
        encoding="utf-8",
    )
    return folder
