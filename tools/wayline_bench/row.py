"""Pure: one line of a bench's table, its arithmetic and how it is written."""

from collections.abc import Sequence

import msgspec
import numpy as np

HEAD = ("what", "ours", "yardstick", "ratio (quartiles)", "bar")


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """What was measured beside its yardstick; the ratio is ours to the yardstick."""

    what: str
    ours: float
    yardstick: float
    yardstick_name: str
    unit: str
    """Of ours and the yardstick; empty for a bare number."""
    ratio: float
    ratio_low: float
    ratio_high: float
    """Quartiles over the rounds."""
    bar: float | None = None
    """The largest ratio that will do; None where none is asked for."""

    @property
    def holds(self) -> bool:
        """Whether the bar, if any, is met."""
        return self.bar is None or self.ratio <= self.bar

    def cells(self) -> tuple[str, ...]:
        """The row as texts, in the order of HEAD."""
        verdict = "" if self.bar is None else f"{self.bar:g} {'met' if self.holds else 'MISSED'}"
        return (
            self.what,
            f"{_number(self.ours)} {self.unit}".rstrip(),
            f"{_number(self.yardstick)} {self.unit}".rstrip() + f" {self.yardstick_name}",
            f"{_ratio(self.ratio)} ({_ratio(self.ratio_low)} to {_ratio(self.ratio_high)})",
            verdict,
        )


def compared(
    what: str,
    ours: Sequence[float],
    yardstick: Sequence[float],
    yardstick_name: str,
    *,
    unit: str = "",
    bar: float | None = None,
) -> Row:
    """Rounds side by side: the median of their ratios, so that a busy moment counts once."""
    ratios = np.array(ours) / np.array(yardstick)
    low, median, high = np.quantile(ratios, (0.25, 0.5, 0.75))
    return Row(
        what=what,
        ours=float(np.median(ours)),
        yardstick=float(np.median(yardstick)),
        yardstick_name=yardstick_name,
        unit=unit,
        ratio=float(median),
        ratio_low=float(low),
        ratio_high=float(high),
        bar=bar,
    )


def table(rows: Sequence[Row]) -> str:
    """Markdown, aligned, so that it reads in a terminal and can be pasted into a page."""
    lines = [HEAD, *(row.cells() for row in rows)]
    widths = [max(len(cells[column]) for cells in lines) for column in range(len(HEAD))]
    rule = tuple("-" * width for width in widths)
    return "\n".join(_line(cells, widths) for cells in (HEAD, rule, *lines[1:]))


def _number(value: float) -> str:
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def _ratio(value: float) -> str:
    """Two decimals, more where a share is so small that they would not tell it."""
    return f"{value:.2f}" if abs(value) >= 0.1 else f"{value:.2g}"


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    padded = (cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
    return f"| {' | '.join(padded)} |"
