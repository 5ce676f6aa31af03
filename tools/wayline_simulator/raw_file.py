"""Pure: raw measurements as rows of a CSV, and the `[[raw]]` table that reads them."""

from collections.abc import Iterable, Iterator

from wayline.drive import RawColumns, RawSource
from wayline_simulator.constellation import System
from wayline_simulator.raw_epochs import Measured

RAW_NAME = "raw.csv"
FORMATS = {
    "t_s": "%.3f",
    "system": "%s",
    "prn": "%d",
    "pseudorange_m": "%.3f",
    "pseudorange_std_m": "%.3f",
    "doppler_hz": "%.3f",
    "doppler_std_hz": "%.3f",
    "cn0_dbhz": "%.1f",
    "carrier_hz": "%.0f",
    "elevation_deg": "%.2f",
    "azimuth_deg": "%.2f",
    "line_of_sight": "%d",
    "x_m": "%.4f",
    "y_m": "%.4f",
    "z_m": "%.4f",
    "vx_mps": "%.4f",
    "vy_mps": "%.4f",
    "vz_mps": "%.4f",
}


def raw_source() -> RawSource:
    """The `[[raw]]` of a simulated drive: clocks and air are those of no satellite and no day."""
    columns = {name: name for name in FORMATS if name != "t_s"}
    return RawSource(
        path=RAW_NAME,
        columns=RawColumns(time="t_s", **columns),
        corrected=("atmosphere", "satellite_clock"),
    )


def raw_lines(parts: Iterable[Measured], systems: tuple[System, ...]) -> Iterator[bytes]:
    """The file's text, some rows at a time."""
    yield (",".join(FORMATS) + "\n").encode()
    line = ",".join(FORMATS.values()) + "\n"
    for part in parts:
        names = [systems[number] for number in part.systems.tolist()]
        columns = [
            column.tolist() for column in (*part[2:-2], *part.places_m.T, *part.motions_mps.T)
        ]
        rows = zip(part.times_s.tolist(), names, *columns, strict=True)
        yield "".join(line % row for row in rows).encode()
