"""Shows what `wayline doctor can` found."""

from collections.abc import Iterator

from rich.table import Table

from wayline_can_ingest.diagnosis.diagnose import Diagnosis
from wayline_can_ingest.diagnosis.findings import Arriving, missing


def summary(diagnosis: Diagnosis) -> Iterator[str]:
    """Lines before the table."""
    if diagnosis.frames:
        rate_hz = diagnosis.frames / diagnosis.lasted_s
        yield (
            f"{diagnosis.frames:,} frames in {diagnosis.lasted_s:,.1f} s ({rate_hz:,.0f}/s), "
            f"{diagnosis.identifiers} identifiers, {diagnosis.extended} of them with 29 bits"
        )
        for fit in diagnosis.profiles:
            yield f"profile {fit.name} fits: {fit.seen} of its {fit.mapped} messages come"
        if not diagnosis.profiles:
            yield "no profile fits"


def quantities(diagnosis: Diagnosis) -> Table:
    """What arrives, by whom it is read."""
    table = Table("quantity", "rate", "from least to most", "by", box=None, pad_edge=False)
    table.columns[1].justify = "right"
    readers: dict[Arriving, list[str]] = {}
    for fit in diagnosis.fits:
        for arriving in fit.arriving:
            readers.setdefault(arriving, []).append(fit.name)
    for quantity, rate_hz, values in sorted(readers):
        names = ", ".join(readers[Arriving(quantity, rate_hz, values)])
        table.add_row(quantity, f"{rate_hz:.3g} Hz", values, names)
    return table


def shortcomings(diagnosis: Diagnosis) -> Iterator[str]:
    """Lines behind the table."""
    if not diagnosis.fits:
        return
    empty, absent = missing(diagnosis.fits)
    if empty:
        yield f"come without a value: {', '.join(empty)}"
    if "torque.engine_torque_nm" in empty:
        yield "torque comes in percent: set vehicle.engine_reference_torque_nm"
    if absent:
        yield f"missing: {', '.join(absent)}"


def tables(diagnosis: Diagnosis) -> Iterator[str]:
    """Text to paste."""
    if diagnosis.profile_table is not None:
        yield "# the profile, to paste:"
        yield diagnosis.profile_table
    if diagnosis.can_table is not None:
        if diagnosis.profile_table is not None:
            yield ""
        yield "# the mapping proposed, to paste:"
        yield diagnosis.can_table
