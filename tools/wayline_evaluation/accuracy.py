"""Pure: errors of one drive or many, summed up and set against a yardstick."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import msgspec
import numpy as np

from wayline_evaluation.figures import (
    Consistency,
    Errors,
    consistency_of,
    errors_of,
    ratio_of,
)
from wayline_evaluation.pose_errors import PoseErrors, pooled
from wayline_evaluation.reference import Kind

Part = Literal["all", "gps", "dead_reckoning"]
NEAR_M = 15.0
"""Poses this near to the recorded fixes are said to lie on them."""


class PartAccuracy(msgspec.Struct, frozen=True, kw_only=True):
    """Errors of all poses, of poses with GPS, or of poses without (dead_reckoning, lost)."""

    errors: Errors
    consistency: Consistency | None
    """Null against fixes: the poses were made from them."""
    within_15_m_share: float


class Accuracy(msgspec.Struct, frozen=True, kw_only=True):
    """Of one filter."""

    missing_share: float
    """Instants with a reference, but without a position."""
    parts: dict[Part, PartAccuracy]


class DriveAccuracy(msgspec.Struct, frozen=True, kw_only=True):
    """Accuracy of one drive, or of all drives pooled."""

    drive: str
    reference: Kind
    """`fixes`: no truth; the horizontal error is the distance to the recorded fixes."""
    filters: dict[str, Accuracy]
    """By name: fusion, yardstick."""
    ratios: dict[Part, Errors]
    """Fusion's figures over the yardstick's; empty without one."""


class AccuracyReport(msgspec.Struct, frozen=True, kw_only=True):
    """What `wayline evaluate accuracy --json` writes."""

    drives: tuple[DriveAccuracy, ...]
    pooled: DriveAccuracy


@dataclass(frozen=True, slots=True)
class ScoredDrive:
    """The errors of one drive by filter."""

    drive: str
    reference: Kind
    errors: Mapping[str, PoseErrors]


def accuracy_report(drives: Sequence[ScoredDrive]) -> AccuracyReport:
    """Every drive by itself and all of them together."""
    names = [name for name in drives[0].errors if all(name in each.errors for each in drives)]
    everything = ScoredDrive(
        drive="pooled",
        reference=drives[0].reference,
        errors={name: pooled([each.errors[name] for each in drives]) for name in names},
    )
    return AccuracyReport(
        drives=tuple(_drive_accuracy(each) for each in drives), pooled=_drive_accuracy(everything)
    )


def _drive_accuracy(scored: ScoredDrive) -> DriveAccuracy:
    filters = {
        name: Accuracy(
            missing_share=float(np.mean(np.isnan(errors.horizontal_m))),
            parts=_parts(errors, scored.reference),
        )
        for name, errors in scored.errors.items()
    }
    return DriveAccuracy(
        drive=scored.drive,
        reference=scored.reference,
        filters=filters,
        ratios=_ratios(filters),
    )


def _parts(errors: PoseErrors, reference: Kind) -> dict[Part, PartAccuracy]:
    dead = errors.dead_reckoning
    parts: dict[Part, PartAccuracy] = {"all": _part(errors, reference)}
    if dead.any() and not dead.all():
        parts["gps"] = _part(errors.where(~dead), reference)
        parts["dead_reckoning"] = _part(errors.where(dead), reference)
    return parts


def _part(errors: PoseErrors, reference: Kind) -> PartAccuracy:
    # what has no position lies on no fix
    near = errors.horizontal_m <= NEAR_M
    return PartAccuracy(
        errors=errors_of(errors),
        consistency=consistency_of(errors) if reference == "truth" else None,
        within_15_m_share=float(np.mean(near)),
    )


def _ratios(filters: Mapping[str, Accuracy]) -> dict[Part, Errors]:
    if "yardstick" not in filters:
        return {}
    ours, bars = filters["fusion"].parts, filters["yardstick"].parts
    return {
        part: Errors(
            **{
                name: ratio_of(getattr(ours[part].errors, name), getattr(bars[part].errors, name))
                for name in Errors.__struct_fields__
            }
        )
        for part in ours
        if part in bars
    }
