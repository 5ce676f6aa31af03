"""Pure: how weak a signal is found in a search over frequencies, by detection statistics.

Correlations of 10 ms are squared and added up for a second; the largest sum of all cells is held
against a threshold that noise alone passes in one search of a thousand. Without a signal a sum is
chi-square with two degrees of freedom a correlation, with one it is noncentral (S. Kay,
Fundamentals of statistical signal processing, volume II, 1998). The more cells, the higher the
threshold.
"""

import math

import msgspec
import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2, ncx2

from wayline_evaluation.estimates import Floats
from wayline_evaluation.tracking.fll import (
    INTEGRATION_S,
    STRONGEST_DBHZ,
    WEAKEST_DBHZ,
    ratio_hz,
)

SIGMAS = 3.0
"""An aid's range is searched so far to either side."""
OFFSETS = np.linspace(0.0, 1.0, 21)
"""Where in its cell a signal may lie, in shares of half the cell."""


class SearchModel(msgspec.Struct, frozen=True, kw_only=True):
    """How a receiver searches; judgements."""

    correlations: int = 100
    """A second of them."""
    cell_hz: float = 50.0
    """1 / (2 T): at the edge 0.9 dB are lost."""
    code_cells: int = 2046
    """Half chips: after an outage the code's phase may be any."""
    false_alarm: float = 1e-3
    """Of a whole search."""
    detection: float = 0.9


class Search(msgspec.Struct, frozen=True, kw_only=True):
    """One range of frequencies searched."""

    name: str
    half_range_hz: float
    frequency_cells: int
    cell_hz: float
    """Width of one: what is narrower than a cell has one that is as narrow."""
    cells: int
    false_alarm_a_cell: float
    threshold: float
    """Of the sum, over the noise's variance in one phase."""
    needed_dbhz: float
    """C/N0 that is detected, the signal lying anywhere in its cell."""
    seconds: float
    """Of one correlator that looks at cell after cell."""


def search(name: str, half_range_hz: float, model: SearchModel) -> Search:
    """What it takes to search from -half_range_hz to half_range_hz."""
    frequency_cells = max(math.ceil(2.0 * half_range_hz / model.cell_hz), 1)
    cell_hz = 2.0 * half_range_hz / frequency_cells
    cells = frequency_cells * model.code_cells
    alarm = -math.expm1(math.log1p(-model.false_alarm) / cells)
    threshold = float(chi2.isf(alarm, 2 * model.correlations))
    return Search(
        name=name,
        half_range_hz=half_range_hz,
        frequency_cells=frequency_cells,
        cell_hz=cell_hz,
        cells=cells,
        false_alarm_a_cell=alarm,
        threshold=threshold,
        needed_dbhz=_needed_dbhz(threshold, cell_hz, model),
        seconds=cells * model.correlations * INTEGRATION_S,
    )


def detected(cn0_hz: float, threshold: float, cell_hz: float, model: SearchModel) -> float:
    """Probability, over all places within the cell."""
    offsets_hz: Floats = 0.5 * cell_hz * OFFSETS
    seen = np.square(np.sinc(offsets_hz * INTEGRATION_S))
    strength = 2.0 * cn0_hz * INTEGRATION_S * model.correlations * seen
    return float(np.mean(ncx2.sf(threshold, 2 * model.correlations, strength)))


def _needed_dbhz(threshold: float, cell_hz: float, model: SearchModel) -> float:
    def excess(cn0_dbhz: float) -> float:
        return detected(ratio_hz(cn0_dbhz), threshold, cell_hz, model) - model.detection

    return float(brentq(excess, WEAKEST_DBHZ, STRONGEST_DBHZ))


def cells_only_db(without: Search, aided: Search, model: SearchModel) -> float:
    """What fewer cells alone bring, the signal in the middle of its own."""
    narrow_hz = 1e-9
    needed = [_needed_dbhz(each.threshold, narrow_hz, model) for each in (without, aided)]
    return needed[0] - needed[1]
