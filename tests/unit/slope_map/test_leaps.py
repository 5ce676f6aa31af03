"""Where position and odometer disagree, no road leads from the one place to the other."""

import msgspec
import pytest

from unit.slope_map.hilly_road import core, drive, runs_of
from wayline.messages import Pose

HALFWAY_M = 3_000.0


def leaping(north_deg: float, *, std_m: float = 2.0) -> list[msgspec.Struct]:
    """A drive whose poses lie so far to the north from halfway on, by no metre of the wheels."""
    return [
        msgspec.structs.replace(
            message,
            lat_deg=(message.lat_deg or 0.0) + (north_deg if message.distance_m > HALFWAY_M else 0),
            east_std_m=std_m,
            north_std_m=std_m,
        )
        if isinstance(message, Pose)
        else message
        for message in drive(seed=3)
    ]


@pytest.mark.parametrize("north_deg", [0.045, 0.0936])
def test_a_teleport_and_a_ferry_make_no_road_across(north_deg: float) -> None:
    """5 km, as a receiver that lied; 10.4 km, as over water."""
    runs = runs_of(core(), leaping(north_deg))
    assert len(runs) == 2
    lengths_m = [run.road.line.length_m for run in runs]
    assert lengths_m == pytest.approx([HALFWAY_M, HALFWAY_M], abs=50.0)


def test_a_pose_that_comes_back_by_less_than_it_was_unsure_of_goes_on() -> None:
    (run,) = runs_of(core(), leaping(0.0005, std_m=20.0))
    assert run.road.line.length_m == pytest.approx(2.0 * HALFWAY_M, rel=0.02)
