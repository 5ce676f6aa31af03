"""Pure: what `[tuning] architecture` may name, and what belongs to it."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from wayline.tuning import Tuning
from wayline.vertical.propulsion import Push
from wayline_fusion.aids.altitude import Altitude
from wayline_fusion.aids.own_slope import VehicleSlope
from wayline_fusion.aids.pressure import AirPressure
from wayline_fusion.aids.torque import TorqueSlope
from wayline_fusion.architectures.architecture import Architecture
from wayline_fusion.architectures.gps_only import GpsOnly, by_quality, same_for_all
from wayline_fusion.architectures.loose import Loose
from wayline_fusion.architectures.measurement import measurement
from wayline_fusion.architectures.uncoupled import Uncoupled
from wayline_fusion.filter.vertical import VerticalAid, VerticalEstimate
from wayline_fusion.intake.events import (
    Event,
    GpsAltitude,
    Pressure,
    ReportedSlope,
)
from wayline_fusion.keeping.keeper import EstimateKeeper, Keeper, NoKeeper
from wayline_fusion.keeping.records import Saved


class Chosen(NamedTuple):
    """An architecture, the altitude along its way, and what keeps both over a restart."""

    architecture: Architecture
    vertical: VerticalEstimate
    keeper: Keeper


Build = Callable[[Tuning, Saved | None], Chosen]
"""Makes an architecture that begins with what was kept of the vehicle."""


def _keeping(make: Callable[[Tuning], Loose]) -> Build:
    """For an architecture whose calibration and pose outlive a restart."""

    def build(tuning: Tuning, saved: Saved | None) -> Chosen:
        architecture = make(tuning)
        vertical = _vertical(tuning, architecture)
        return Chosen(architecture, vertical, EstimateKeeper(architecture, vertical, saved, tuning))

    return build


def _forgetful(make: Callable[[Tuning], Architecture]) -> Build:
    """For an architecture that learns nothing."""

    def build(tuning: Tuning, _: Saved | None) -> Chosen:
        architecture = make(tuning)
        return Chosen(architecture, _vertical(tuning, architecture), NoKeeper())

    return build


def _vertical(tuning: Tuning, architecture: Architecture) -> VerticalEstimate:
    aids: Mapping[type[Event], VerticalAid] = {
        GpsAltitude: Altitude(),
        Pressure: AirPressure(),
        Push: TorqueSlope(),
        ReportedSlope: VehicleSlope(),
    }
    return VerticalEstimate(tuning, architecture, aids)


ARCHITECTURES: Mapping[str, Build] = {
    "loose": _keeping(Loose),
    "measurement": _keeping(measurement),
    "uncoupled": _forgetful(Uncoupled),
    "gps_only": _forgetful(lambda tuning: GpsOnly(tuning, same_for_all)),
    "gps_only_modified": _forgetful(lambda tuning: GpsOnly(tuning, by_quality)),
}


def chosen(tuning: Tuning, saved: Saved | None) -> Chosen:
    """The architecture that the tuning names, beginning with what was kept of the vehicle."""
    return ARCHITECTURES[tuning.architecture](tuning, saved)
