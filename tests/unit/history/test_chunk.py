"""Rows as bytes: the same when read back, few, and each once when chunks are joined."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from builders import at, fix
from unit.history.driven import LAT_DEG, LON_DEG, legs, pose
from wayline_history.chunk import Chunk, chunk_of, decoded, encoded, merged
from wayline_history.layouts import FIXES, NULL, POSES
from wayline_history.points import points_of
from wayline_history.thinning import thinned

BESIDE: dict[str, Any] = {"engine": NULL}


def poses_chunk(poses: Any) -> Chunk:
    return chunk_of(POSES, [POSES.row(each, {}, **BESIDE) for each in poses])


WIDTH = len(POSES.columns)
steps = st.integers(-(2**52), 2**52) | st.just(NULL)
rows = st.lists(st.tuples(st.integers(0, 2**51), *([steps] * (WIDTH - 1))), min_size=1, max_size=9)


@given(rows)
def test_what_is_read_back_is_what_was_written(given_rows: list[tuple[int, ...]]) -> None:
    chunk = chunk_of(POSES, given_rows)
    again = decoded(POSES, encoded(chunk))
    assert np.array_equal(again.values, chunk.values)


def test_bytes_of_another_version_are_refused() -> None:
    data = encoded(poses_chunk(legs((3, 1.0))))
    with pytest.raises(ValueError, match="version 9"):
        decoded(POSES, b"\x09" + data[1:])


def test_an_hour_of_poses_takes_few_bytes() -> None:
    chance = np.random.default_rng(1)
    drive = [
        pose(s, 15.0 * s + chance.normal(0, 0.05), 15.0 + chance.normal(0, 0.1), grade_pct=0.5)
        for s in range(3600)
    ]
    assert len(encoded(poses_chunk(drive))) / 3600 < 20.0


def test_joined_chunks_hold_each_row_once_in_order_of_time() -> None:
    drive = list(legs((20, 10.0)))
    late, twice = poses_chunk(drive[3:6]), poses_chunk(drive[10:15])
    rest = poses_chunk([*drive[:3], *drive[6:]])
    joined = merged(POSES, [rest, late, twice])
    assert np.array_equal(joined.values, poses_chunk(drive).values)


def test_two_receivers_at_one_instant_are_two_rows() -> None:
    texts: dict[str, int] = {}
    both = [FIXES.row(fix(1.0, LAT_DEG, LON_DEG), texts, source=name) for name in ("a", "b")]
    chunk = chunk_of(FIXES, both, texts)
    other: dict[str, int] = {}
    again = [FIXES.row(fix(1.0, LAT_DEG, LON_DEG), other, source=name) for name in ("b", "c")]
    joined = merged(FIXES, [chunk, chunk_of(FIXES, again, other)])
    assert [point.source for point in points_of(joined)] == ["a", "b", "c"]  # type: ignore[attr-defined]


def test_points_show_units_and_unknown_as_null() -> None:
    (point,) = points_of(poses_chunk([pose(1.0, 0.0, -3.25, alt_m=None)]))
    told = {name: getattr(point, name) for name in point.__struct_fields__}
    assert told["t"] == "2023-11-14T22:13:21.000Z"
    assert (told["lat_deg"], told["speed_mps"], told["alt_m"]) == (LAT_DEG, -3.25, None)
    assert (told["mode"], told["grade_pct"]) == ("fused", None)


def off_m(drive: list[Any], kept: Chunk) -> float:
    """The largest distance of a pose from the line between its neighbours that stay, in stds."""
    chunk = poses_chunk(drive)
    worst = 0.0
    for name, bound in (("lat_deg", 1.0 / 111_320), ("lon_deg", 1.0 / 74_345), ("alt_m", 2.0)):
        place = POSES.place(name)
        per_unit = POSES.columns[place].per_unit
        line = np.interp(chunk.times_us, kept.times_us, kept.values[:, place] / per_unit)
        worst = max(worst, float(np.max(np.abs(line - chunk.values[:, place] / per_unit)) / bound))
    return worst


def bendy(seconds: int) -> list[Any]:
    """A drive that goes on evenly, then bends, climbs and brakes, known to a metre and more."""
    drive = []
    for s in range(seconds):
        north_m = 300.0 * np.sin(s / 60.0)
        drive.append(
            pose(
                s,
                12.0 * s,
                12.0,
                lat_deg=LAT_DEG + north_m / 111_320,
                alt_m=500 + 20 * np.sin(s / 90),
            )
        )
    return drive


def test_thinned_poses_tell_all_others_within_their_bound() -> None:
    drive = bendy(3600)
    kept = thinned(poses_chunk(drive))
    assert len(kept) < 0.4 * len(drive)
    assert off_m(drive, kept) <= 1.5  # a metre in each of two directions


def test_a_parked_hour_is_two_poses() -> None:
    assert len(thinned(poses_chunk(legs((3600, 0.0))))) == 2


def test_thinning_keeps_changes_of_mode() -> None:
    drive = [pose(s, 10.0 * s, 10.0, mode="fused" if s < 50 else "gps") for s in range(100)]
    kept = thinned(poses_chunk(drive))
    modes = [point.mode for point in points_of(kept)]  # type: ignore[attr-defined]
    assert modes == ["fused", "fused", "gps", "gps"]


def test_thinning_goes_over_the_antimeridian() -> None:
    drive = []
    for s in range(200):
        lon_deg = 179.999 + 1e-5 * s
        drive.append(pose(s, 0.0, 1.0, lon_deg=(lon_deg + 180.0) % 360.0 - 180.0, distance_m=s))
    assert len(thinned(poses_chunk(drive))) <= 4


def test_time_is_kept_to_the_microsecond() -> None:
    assert poses_chunk([pose(0.123456, 0, 0)]).times_us[0] == at(0.123456) // 1000
