"""Detection statistics of a search over frequencies."""

import msgspec
import numpy as np
import pytest

from wayline_evaluation.tracking.acquisition import Search, SearchModel, detected, search
from wayline_evaluation.tracking.figures import acquisition
from wayline_evaluation.tracking.fll import INTEGRATION_S, ratio_hz

FEW_CELLS = SearchModel(code_cells=8, correlations=20, false_alarm=0.2)


def sums(searched: Search, model: SearchModel, cn0_hz: float, count: int) -> np.ndarray:
    """Of correlations with a signal in the middle of its cell, shape (count, cells)."""
    random = np.random.default_rng(3)
    shape = (count, model.correlations, searched.cells)
    noise = random.standard_normal(shape) + 1j * random.standard_normal(shape)
    noise[:, :, 0] += np.sqrt(2.0 * cn0_hz * INTEGRATION_S)
    added: np.ndarray = np.sum(np.square(np.abs(noise)), axis=1)
    return added


def test_noise_alone_alarms_as_often_as_told() -> None:
    searched = search("", 100.0, FEW_CELLS)
    alarms = sums(searched, FEW_CELLS, 0.0, 3000).max(axis=1) > searched.threshold
    assert float(np.mean(alarms)) == pytest.approx(FEW_CELLS.false_alarm, abs=0.03)


def test_a_signal_is_found_as_often_as_told() -> None:
    searched, cn0_hz = search("", 100.0, FEW_CELLS), ratio_hz(20.0)
    found = sums(searched, FEW_CELLS, cn0_hz, 3000)[:, 0] > searched.threshold
    told = detected(cn0_hz, searched.threshold, 1e-9, FEW_CELLS)
    assert 0.2 < told < 0.98
    assert float(np.mean(found)) == pytest.approx(told, abs=0.03)


def test_more_cells_need_a_stronger_signal() -> None:
    few, many = search("", 25.0, SearchModel()), search("", 2500.0, SearchModel())
    assert many.cells == 100 * few.cells
    assert many.needed_dbhz > few.needed_dbhz + 0.3


def test_what_is_narrower_than_a_cell_loses_nothing_at_its_edge() -> None:
    wide, narrow = search("", 25.0, SearchModel()), search("", 1.0, SearchModel())
    assert wide.cells == narrow.cells
    assert wide.threshold == narrow.threshold
    assert 0.2 < wide.needed_dbhz - narrow.needed_dbhz < 0.9


def test_a_worse_aid_gains_less() -> None:
    good, bad = (acquisition(std_hz, SearchModel())[0].gained_db for std_hz in (0.5, 60.0))
    assert good is not None
    assert bad is not None
    assert 0.0 < bad < good


def test_time_saved_and_spent_on_looking_longer_gains_more() -> None:
    row = acquisition(1.0, msgspec.structs.replace(SearchModel(), code_cells=64))[0]
    assert row.gained_same_time_db is not None
    assert row.gained_db is not None
    assert row.gained_by_cells_db is not None
    assert row.gained_same_time_db > row.gained_db > row.gained_by_cells_db > 0.0
