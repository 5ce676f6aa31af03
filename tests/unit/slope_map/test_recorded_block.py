"""The same block driven twice, recorded: the second run knows the road, and agrees."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import sqlalchemy as sa

from wayline.database import open_database
from wayline_replay.replay import replay
from wayline_slope_map.store import SlopeStore
from wayline_slope_map.tables import SUMS


def fused_sums(engine: sa.Engine) -> dict[int, np.ndarray]:
    columns = [SUMS.c[name] for name in ("runs", "grade_weight", "grade_sum", "alt_weight")]
    query = sa.select(SUMS.c.bin_index, *columns).where(SUMS.c.sensor == "fused")
    with engine.connect() as connection:
        return {index: np.array(sums) for index, *sums in connection.execute(query)}


def test_two_runs_round_the_block_are_two_runs_of_one_road_that_agree(
    recorded: Callable[[str], Path], tmp_path: Path
) -> None:
    block = recorded("ikhyd-trip2")
    url = f"sqlite:///{tmp_path}/slope.db"
    replay(block, tmp_path / "first", database_url=url)
    engine = open_database(url, "wayline_slope_map")
    first = fused_sums(engine)
    replay(block, tmp_path / "first-again", database_url=url)
    assert {index: sums.tolist() for index, sums in fused_sums(engine).items()} == {
        index: sums.tolist() for index, sums in first.items()
    }
    replay(block / "run2", tmp_path / "second", database_url=url)
    both = fused_sums(engine)
    roads = SlopeStore(engine).load_roads()
    engine.dispose()
    assert len(roads) == 1
    shared = [index for index, sums in both.items() if sums[0] == 2]
    assert len(shared) >= 35
    first_pct = np.array([first[i][2] / first[i][1] for i in shared])
    second = [both[i] - first[i] for i in shared]
    second_pct = np.array([sums[2] / sums[1] for sums in second])
    steep = np.abs(first_pct) > 3.0
    assert np.count_nonzero(steep) >= 10
    assert np.all(np.sign(first_pct[steep]) == np.sign(second_pct[steep]))
    # papers/004 table 5.2 found a spread of 0.26 % between barometer runs
    assert np.sqrt(np.mean((first_pct - second_pct) ** 2) / 2.0) < 0.5
