"""A recorded drive's raw measurements, as bus messages."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Protocol

from wayline.drive import RawColumns, RawSource
from wayline.errors import InputError
from wayline.messages import Message
from wayline.received import Account, Recording, translated
from wayline_gps_ingest.raw import library
from wayline_gps_ingest.raw.core import RawIngestCore
from wayline_gps_ingest.raw.ephemerides import Placing
from wayline_gps_ingest.raw.epoch import RawEpoch
from wayline_gps_ingest.raw.formats import format_of
from wayline_gps_ingest.raw.table import RawTable

PLACES = ("x_m", "y_m", "z_m")


class RawLog(Protocol):
    """A file of raw measurements; iterates once."""

    @property
    def faults(self) -> Mapping[str, int]:
        """What was counted and dropped or mended so far, by reason."""
        ...

    def __iter__(self) -> Iterator[RawEpoch]:
        """Its epochs in order of time. Raises InputError for a file that cannot be read."""
        ...

    def nothing(self) -> InputError:
        """Why it holds no epoch; asked once it was read."""
        ...


def raw_recording(source: RawSource, name: str) -> Recording:
    """The measurements of one `[[raw]]`. Raises InputError."""
    kind, path = format_of(source), Path(source.path)
    if kind == "csv" and source.columns is not None:
        return _table(source, source.columns, name)
    ephemerides = library.broadcast(source.navs, source.path)
    placing, core = Placing(ephemerides), RawIngestCore(air=ephemerides, recorded=True)
    if kind == "rinex":
        return _recording(library.rinex_log(path, placing), core, name, placing, source)
    log = library.ubx_log(path, placing, None if source.navs else ephemerides)
    return _recording(log, core, name, placing, source)


def _table(source: RawSource, columns: RawColumns, name: str) -> Recording:
    needs_air = "atmosphere" not in source.corrected
    is_placed = any(getattr(columns, place) is not None for place in PLACES)
    needs_library = bool(source.navs) or (needs_air and is_placed)
    ephemerides = library.broadcast(source.navs, source.path) if needs_library else None
    core = RawIngestCore(source.corrected, air=ephemerides, recorded=True)
    placing = Placing(ephemerides) if ephemerides is not None and source.navs else None
    return _recording(RawTable(source, columns, placing), core, name, placing, source)


def _recording(
    log: RawLog, core: RawIngestCore, name: str, placing: Placing | None, source: RawSource
) -> Recording:
    warnings = list(_clockless(source))

    def messages() -> Iterator[tuple[int, Message]]:
        yield from translated(log, core.handle, name, lambda _, epoch: epoch.t_ns)
        warnings.extend(_placeless(source, placing))
        warnings.extend(_unsorted(source, log.faults))

    def account() -> Account:
        return Account({} if placing is None else dict(placing.without), tuple(warnings))

    return Recording(
        name,
        messages(),
        lambda: core.bad_input + sum(log.faults.values()),
        account,
        log.nothing,
    )


def _clockless(source: RawSource) -> Iterator[str]:
    """Where nothing tells a table's satellites' clocks, which are off by up to 300 km."""
    columns = source.columns
    if columns is None or source.navs:
        return
    if "satellite_clock" not in source.corrected and columns.clock_bias_m is None:
        mend = 'name "satellite_clock" in corrected, the column of clock_bias_m, or nav = [...]'
        yield f"{source.path}: nothing tells the satellites' clocks; {mend}"


def _placeless(source: RawSource, placing: Placing | None) -> Iterator[str]:
    """Where no satellite of a whole log got a place."""
    if placing is not None and placing.without and not placing.placed:
        reason = placing.without.most_common(1)[0][0]
        mend = "give nav = [...] of its day, or record RXM-SFRBX from its start"
        yield f"{source.path}: no satellite has a place ({reason}); {mend}"


def _unsorted(source: RawSource, faults: Mapping[str, int]) -> Iterator[str]:
    """Where rows were lost by their order, as those of a table sorted by satellite are."""
    if late := faults.get("late"):
        what = f"{late:,} rows come over 2 s after later ones and are left out"
        yield f"{source.path}: {what}; sort it by time"
