"""A recorded drive's raw measurements, as bus messages."""

from functools import partial

from wayline.drive import RawColumns, RawSource
from wayline.errors import InputError
from wayline.received import Account, Recording, translated
from wayline_gps_ingest.raw.core import RawIngestCore
from wayline_gps_ingest.raw.table import RawTable


def raw_recording(source: RawSource, name: str) -> Recording:
    """The measurements of one `[[raw]]`. Raises InputError."""
    if source.columns is None:
        raise InputError(source.path, "no columns are named", "add columns to its [[raw]]")
    return _table(source, source.columns, name)


def _table(source: RawSource, columns: RawColumns, name: str) -> Recording:
    core = RawIngestCore(source.corrected, recorded=True)
    table = RawTable(source, columns)
    messages = translated(table, core.handle, name, lambda _, epoch: epoch.t_ns)
    return Recording(
        name,
        messages,
        lambda: core.bad_input + table.faults.total(),
        partial(Account, warnings=_unsaid(source, columns)),
        partial(_nothing, source, table),
    )


def _unsaid(source: RawSource, columns: RawColumns) -> tuple[str, ...]:
    """A satellite's clock is off by up to 300 km: who does not say where it is should know."""
    if "satellite_clock" in source.corrected or columns.clock_bias_m is not None:
        return ()
    mend = 'name "satellite_clock" in corrected, or the column of clock_bias_m'
    return (f"{source.path}: nothing tells the satellites' clocks; {mend}",)


def _nothing(source: RawSource, table: RawTable) -> InputError:
    counted = ", ".join(f"{times:,} {why}" for why, times in sorted(table.faults.items()))
    what = f"none of its {table.rows:,} rows measures a satellite ({counted or 'it is empty'})"
    mend = "check its columns: time ISO 8601 or Unix seconds, prn, pseudorange_m or doppler_hz"
    return InputError(source.path, what, mend)
