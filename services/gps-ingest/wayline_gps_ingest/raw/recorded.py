"""A recorded drive's raw measurements, as bus messages."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Protocol

from wayline.drive import RawColumns, RawSource
from wayline.errors import InputError
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
    def account() -> Account:
        left_out = {} if placing is None else dict(placing.without)
        return Account(left_out, _warnings(source, placing))

    return Recording(
        name,
        translated(log, core.handle, name, lambda _, epoch: epoch.t_ns),
        lambda: core.bad_input + sum(log.faults.values()),
        account,
        log.nothing,
    )


def _warnings(source: RawSource, placing: Placing | None) -> tuple[str, ...]:
    """What leaves measurements without use."""
    columns = source.columns
    if placing is not None:
        if placing.placed or not placing.without:
            return ()
        reason = placing.without.most_common(1)[0][0]
        mend = "give nav = [...] of its day, or record RXM-SFRBX from its start"
        return (f"{source.path}: no satellite has a place ({reason}); {mend}",)
    # a satellite's clock is off by up to 300 km
    if columns is None or "satellite_clock" in source.corrected or columns.clock_bias_m is not None:
        return ()
    mend = 'name "satellite_clock" in corrected, the column of clock_bias_m, or nav = [...]'
    return (f"{source.path}: nothing tells the satellites' clocks; {mend}",)
