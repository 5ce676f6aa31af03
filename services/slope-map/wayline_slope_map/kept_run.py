"""Pure: a merged run in few bytes, kept so that it can be judged and withdrawn.

What is merged is the run as it is kept, rounded, so that taking it out again leaves the sums as
they were to the last digit. Grades along a road change little from bin to bin: their differences
are small whole numbers, which zlib makes smaller still (some 300 bytes a km of 20 m bins).
"""

import math
import zlib
from collections.abc import Iterable, Sequence
from itertools import groupby

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline_slope_map.records import RunBin, Sensor

Whole = NDArray[np.int64]
GRADE_STEP_PCT = 0.005
STD_STEPS = 1000.0
"""Of the logarithm of a std: 0.1 % apart."""
ALT_STEP_M = 0.05
ALT_STD_MAX_M = 100.0
"""An altitude known worse is none, and only that of all sensors together is kept."""
UNKNOWN = -1


class _Part(msgspec.Struct, frozen=True, array_like=True):
    sensor: Sensor
    count: int


def kept(bins: Sequence[RunBin]) -> bytes:
    """The bins of a run as bytes; the same bins make the same bytes."""
    parts, columns = [], []
    for sensor, of_sensor in _by_sensor(bins):
        parts.append(_Part(sensor, len(of_sensor)))
        columns += [_differences(column) for column in _columns(of_sensor)]
    whole = np.concatenate(columns) if columns else np.empty(0, dtype=np.int64)
    folded = np.where(whole < 0, -2 * whole - 1, 2 * whole).astype(">u4")
    planes = folded.view(np.uint8).reshape(-1, 4).T.tobytes()
    return zlib.compress(msgspec.json.encode(parts) + b"\n" + planes, 9)


def unkept(data: bytes) -> tuple[RunBin, ...]:
    """The bins of a run that was kept, rounded."""
    head, _, planes = zlib.decompress(data).partition(b"\n")
    folded = np.frombuffer(planes, dtype=np.uint8).reshape(4, -1).T.copy().view(">u4").ravel()
    unfolded = folded.astype(np.int64)
    whole = np.where(unfolded % 2, -(unfolded + 1) // 2, unfolded // 2)
    bins: list[RunBin] = []
    for part in msgspec.json.decode(head, type=list[_Part]):
        columns = whole[: 5 * part.count].reshape(5, -1)
        whole = whole[5 * part.count :]
        bins += _bins(part.sensor, [_sums(column) for column in columns])
    return tuple(bins)


def rounded(bins: Sequence[RunBin]) -> tuple[RunBin, ...]:
    """The bins as they come back when they were kept."""
    return unkept(kept(bins))


def _by_sensor(bins: Iterable[RunBin]) -> Iterable[tuple[Sensor, list[RunBin]]]:
    ordered = sorted(bins, key=lambda each: (each.sensor, each.bin_index))
    for sensor, of_sensor in groupby(ordered, key=lambda each: each.sensor):
        yield sensor, list(of_sensor)


def _columns(bins: list[RunBin]) -> list[Whole]:
    """Index, grade, its std, altitude, its std; UNKNOWN std where no altitude is kept."""
    known = [
        each.sensor == "fused"
        and each.alt_m is not None
        and each.alt_std_m is not None
        and each.alt_std_m < ALT_STD_MAX_M
        for each in bins
    ]
    rows = [
        (
            each.bin_index,
            round(each.grade_pct / GRADE_STEP_PCT),
            _logarithm(each.grade_std_pct),
            round((each.alt_m or 0.0) / ALT_STEP_M) if has_alt else 0,
            _logarithm(each.alt_std_m or 0.0) if has_alt else UNKNOWN,
        )
        for each, has_alt in zip(bins, known, strict=True)
    ]
    return list(np.array(rows, dtype=np.int64).T)


def _bins(sensor: Sensor, columns: list[Whole]) -> list[RunBin]:
    return [
        RunBin(
            index,
            sensor,
            grade * GRADE_STEP_PCT,
            _std(std),
            None if alt_std == UNKNOWN else alt * ALT_STEP_M,
            None if alt_std == UNKNOWN else _std(alt_std),
        )
        for index, grade, std, alt, alt_std in zip(
            *(column.tolist() for column in columns), strict=True
        )
    ]


def _logarithm(std: float) -> int:
    """From 0.001 up."""
    return max(round(STD_STEPS * math.log(max(std, 1e-3) / 1e-3)), 0)


def _std(logarithm: int) -> float:
    return 1e-3 * math.exp(logarithm / STD_STEPS)


def _differences(column: Whole) -> Whole:
    """Second differences: what a road changes its slope by."""
    return np.diff(np.diff(column, prepend=0), prepend=0)


def _sums(column: Whole) -> Whole:
    sums: Whole = np.cumsum(np.cumsum(column))
    return sums
