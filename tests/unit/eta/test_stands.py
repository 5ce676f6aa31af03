"""How long vehicles that stand go on standing."""

import numpy as np
import pytest

from unit.eta.route_drives import SECOND_NS, START_NS, Metres, follow, poses, route_of
from wayline.tuning import Tuning
from wayline_eta.arrivals import Outlook, later_of, predict_visits
from wayline_eta.core import EtaCore
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.lessons import as_planned
from wayline_eta.stands import goes_on

LINE: list[Metres] = [(0, 0), (3000, 0)]


def test_a_stand_goes_on_for_a_share_of_its_time() -> None:
    stand = goes_on(100.0)
    assert stand.early_s == pytest.approx(5.4, abs=0.1)
    assert stand.left_s == pytest.approx(41.4, abs=0.1)
    assert stand.late_s == pytest.approx(216.2, abs=0.1)


def test_a_stand_between_stops_is_noticed_and_its_late_bound_grows() -> None:
    """It was told to come in the same time all along."""
    core = EtaCore([route_of(LINE, stops_m=[2000.0])], Tuning())
    told = follow(core, poses(LINE, [10.0] * 60 + [0.0] * 300 + [10.0] * 60, noise_m=1.0))

    def to_go(second: int) -> tuple[float, float]:
        one = told[second - (420 - len(told))]
        [stop] = one.arrivals.stops
        now_ns = one.arrivals.t_ns
        return (stop.arrival_ns - now_ns) / SECOND_NS, (stop.late_ns - stop.arrival_ns) / SECOND_NS

    before, early, late, after = (to_go(second) for second in (59, 120, 350, 400))
    assert early[0] < late[0]
    assert early[1] < late[1]
    assert late[1] > 180.0
    assert after[0] < before[0]
    assert after[1] < 40.0


@pytest.mark.parametrize(
    ("first_s", "mean_s", "std_s"),
    [(0.0, 100.0, 10.0), (200.0, 200.0, 20.0), (100.0, 108.9, 12.8)],
)
def test_the_later_of_two_unsure_instants_is_later_than_both(
    first_s: float, mean_s: float, std_s: float
) -> None:
    """Drawn: of two normal ones, 20 s and 10 s wide, that are equal, the later is 8.9 s later."""
    mean, variance, share = later_of((first_s, 400.0), (100.0, 100.0))
    assert mean == pytest.approx(mean_s, abs=0.1)
    assert variance**0.5 == pytest.approx(std_s, abs=0.5)
    assert share == pytest.approx(0.5 + 0.5 * np.sign(first_s - 100.0), abs=0.01)


def test_a_departure_waits_for_its_time_and_so_does_what_follows() -> None:
    """Two minutes early at a timepoint halfway."""
    route = route_of(LINE, stops_m=[1000.0, 2000.0], dwell_s=60.0)
    outlook = Outlook(START_NS, 500.0, 500.0, 0.0)

    def seconds(leaves_s: float) -> list[float]:
        leaves_ns = np.array([START_NS + leaves_s * SECOND_NS, -np.inf])
        first, second = predict_visits(
            as_planned(route, leaves_ns), outlook, START_NS, ExpectedMotion(route, leaves_ns)
        )
        instants_ns = (first.arrival_ns, first.departure_ns, second.arrival_ns)
        return [(each - START_NS) / SECOND_NS for each in instants_ns]

    assert seconds(170.0) == pytest.approx([50.0, 170.0, 270.0], abs=0.1)
    assert seconds(-1.0)[:2] == pytest.approx([50.0, 70.0], abs=0.1)  # boards, no planned wait
