"""How bendy a road is, and how far torque is biased, as a smoothed run tells."""

import numpy as np
import pytest

from wayline.line import Floats
from wayline.tuning import Tuning
from wayline.vertical.states import VerticalStates
from wayline_slope_map.bends import BENDY_FACTOR, CELL_M, Learned, calmed, first, learned

S = VerticalStates
COUNT, SIZE = 400, S.GPS_ERROR + 1
TRAVELLED_M = np.linspace(0.0, 4_000.0, COUNT)


BEFORE = first(COUNT, Tuning(), is_told=True)


def after(
    curvature: Floats, *, std: float = 1e-6, bias: float = 0.0, bias_std: float = 0.0
) -> Learned:
    x, P = np.zeros((COUNT, SIZE)), np.zeros((COUNT, SIZE, SIZE))
    x[:, S.CURVATURE], x[:, S.TORQUE_BIAS] = curvature, bias
    P[:, S.CURVATURE, S.CURVATURE], P[:, S.TORQUE_BIAS, S.TORQUE_BIAS] = std**2, bias_std**2
    return learned(TRAVELLED_M, x, P, Tuning(), BEFORE)


def test_a_vertical_curve_is_bendier_than_the_slopes_beside_it() -> None:
    in_curve = (TRAVELLED_M > 2_000.0) & (TRAVELLED_M < 2_200.0)
    std = after(np.where(in_curve, 3e-4, 1e-6)).curvature_std
    assert std[in_curve].max() == pytest.approx(3e-4, rel=0.2)
    far = np.abs(TRAVELLED_M - 2_100.0) > 100.0 + 3.0 * CELL_M
    assert std[far].max() < 0.1 * std[in_curve].max()


@pytest.mark.parametrize(("factor", "found"), [(0.2, 1.0), (1.4, 1.1 * 1.4), (9.0, BENDY_FACTOR)])
def test_altitudes_tell_how_bendy_a_road_is_as_a_whole_within_bounds(
    factor: float, found: float
) -> None:
    configured = Tuning().curvature_std_pct_per_m / 100.0
    x, P = np.zeros((COUNT, SIZE)), np.zeros((COUNT, SIZE, SIZE))
    x[:, S.CURVATURE] = factor * configured
    std = calmed(TRAVELLED_M, x, P, Tuning(), BEFORE).curvature_std
    assert std == pytest.approx(np.full(COUNT, found * configured))


def test_what_is_not_known_of_the_curvature_counts_as_bends() -> None:
    assert after(np.zeros(COUNT), std=2e-4).curvature_std == pytest.approx(np.full(COUNT, 2e-4))


def test_torque_is_trusted_by_how_far_a_run_finds_it_biased_within_bounds() -> None:
    stated = Tuning().torque_bias_std_pct
    found = [after(np.zeros(COUNT), bias=bias).torque_bias_std_pct for bias in (0.0, 6e-3, 0.5)]
    assert found == pytest.approx([0.3 * stated, 0.6, 3.0 * stated])


def test_what_was_not_found_of_torques_bias_makes_it_no_larger() -> None:
    """Half of the prior's variance is left, so that half of the bias's square was found."""
    assumed_pct = BEFORE.torque_bias_std_pct
    unfound = 0.01 * assumed_pct * 0.5**0.5
    found = after(np.zeros(COUNT), bias=1e-3, bias_std=unfound).torque_bias_std_pct
    assert found == pytest.approx(0.1 * 2.0**0.5)


def test_where_nothing_was_found_of_torques_bias_it_is_bounded() -> None:
    unfound = 0.01 * BEFORE.torque_bias_std_pct
    found = after(np.zeros(COUNT), bias=1e-4, bias_std=unfound).torque_bias_std_pct
    assert found == pytest.approx(0.3 * Tuning().torque_bias_std_pct)
