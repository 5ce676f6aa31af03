"""Pure: the fixes of a GPS receiver: where it errs, when it is blind, how it is late."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.geo import WGS84
from wayline_simulator.course import Surroundings
from wayline_simulator.gps_errors import held, lagged
from wayline_simulator.gps_events import GpsEvents
from wayline_simulator.gps_gaps import lengthened, scheduled
from wayline_simulator.gps_measured import (
    measured_velocities,
    position_errors,
    smoothed_altitudes_m,
)
from wayline_simulator.gps_model import GpsModel
from wayline_simulator.gps_sky import VIEW_STEP_S, View, view_of
from wayline_simulator.journey import Floats, Journey, Truth

__all__ = ["Fixes", "GpsModel", "measure_fixes"]

Flags = NDArray[np.bool_]

DILUTION_TIME_S = 10.0
"""In which a receiver's filter follows a new set of satellites."""
CENTISECONDS_PER_S = 100.0
"""Sentences tell time to two decimals."""


class Fixes(NamedTuple):
    """What a receiver says, an epoch each in order of arrival. Shape (n,) each but for `view`."""

    timestamps_s: Floats
    """Unix seconds, whole parts of a second by the rate."""
    described_s: Floats
    """The instant that the fix is about, in seconds from the drive's start."""
    arrivals_s: Floats
    """Of the first sentence, Unix seconds."""
    valid: Flags
    mode: NDArray[np.int8]
    """1 none, 2, 3; positions and velocities of a 1 are of no meaning."""
    lats_deg: Floats
    lons_deg: Floats
    alts_m: Floats
    speeds_mps: Floats
    courses_deg: Floats
    """nan where the receiver knows none."""
    h_std_m: Floats
    """Per axis, as the receiver believes: reflections are unknown to it."""
    v_std_m: Floats
    hdop: Floats
    vdop: Floats
    pdop: Floats
    repeated: Flags
    """The epoch before once more."""
    rows: NDArray[np.intp]
    """Into `view`."""
    sky_seen: Flags
    """False: nothing is heard, whatever `view` says (an outage)."""
    view: View


def measure_fixes(
    journey: Journey,
    model: GpsModel,
    events: GpsEvents,
    start_s: float,
    random: np.random.Generator,
) -> Fixes:
    """The fixes of a drive that starts at Unix time `start_s`.

    Events count from there by the fixes' timestamps. Raises nothing: a drive too short for an
    epoch has one, at its start.
    """
    step_s = 1.0 / model.rate_hz
    timestamps_s = _timestamps_s(start_s, journey.duration_s, model.rate_hz)
    drive_s = timestamps_s - start_s
    truth = journey.at(drive_s - model.latency_s)
    looks_s = np.arange(0.0, drive_s[-1] + VIEW_STEP_S, VIEW_STEP_S)
    view = view_of(
        journey.at(looks_s),
        start_s,
        systems=model.systems,
        mask_deg=model.mask_deg,
        pdop_max=model.pdop_max,
        random=random,
    )
    rows = np.minimum((drive_s / VIEW_STEP_S).astype(np.intp), len(looks_s) - 1)
    sky_seen = _sky_seen(drive_s, truth, model, events)
    blind = ~sky_seen | (view.mode[rows] == 1)
    valid = ~lengthened(blind, step_s, model.reacquire_s, random)
    mode = np.where(valid, view.mode[rows], 1).astype(np.int8)
    dilutions = _dilutions(view, rows, mode, step_s)
    offsets_m, stds_m = position_errors(truth, valid, dilutions, model, random)
    offsets_m += _displacements_m(drive_s, events)
    lats_deg, lons_deg = _moved(truth, offsets_m)
    speeds_mps, courses_deg = measured_velocities(truth, dilutions[:, 0], model, random)
    fixes = Fixes(
        timestamps_s=timestamps_s,
        described_s=truth.times_s,
        arrivals_s=_arrivals_s(timestamps_s, model, random),
        valid=valid,
        mode=mode,
        lats_deg=lats_deg,
        lons_deg=lons_deg,
        alts_m=smoothed_altitudes_m(truth.alts_m + offsets_m[:, 2], mode, model, step_s),
        speeds_mps=speeds_mps,
        courses_deg=courses_deg,
        h_std_m=stds_m[:, 0],
        v_std_m=stds_m[:, 2],
        hdop=view.hdop[rows],
        vdop=view.vdop[rows],
        pdop=view.pdop[rows],
        repeated=np.zeros(len(rows), dtype=np.bool_),
        rows=rows,
        sky_seen=sky_seen,
        view=view,
    )
    return _sent(fixes, model, random)


def _timestamps_s(start_s: float, duration_s: float, rate_hz: float) -> Floats:
    first = int(np.ceil(start_s * rate_hz))
    count = max(int(np.floor((start_s + duration_s) * rate_hz)) - first + 1, 1)
    return np.round((first + np.arange(count)) / rate_hz * CENTISECONDS_PER_S) / CENTISECONDS_PER_S


def _sky_seen(drive_s: Floats, truth: Truth, model: GpsModel, events: GpsEvents) -> Flags:
    seen = (truth.surroundings < Surroundings.BRIDGE) & (drive_s >= model.first_fix_s)
    for outage in events.outages:
        seen &= ~scheduled(drive_s, outage)
    return seen


def _dilutions(view: View, rows: NDArray[np.intp], mode: NDArray[np.int8], step_s: float) -> Floats:
    """What errors east, north and up are scaled with; the last ones where there is no such fix."""
    hdop = held(view.hdop[rows], mode > 1)
    vdop = held(view.vdop[rows], mode > 2)
    return lagged(np.column_stack((hdop, hdop, vdop)), step_s, DILUTION_TIME_S)


def _displacements_m(drive_s: Floats, events: GpsEvents) -> Floats:
    moved_m = np.zeros((len(drive_s), 3))
    for event in events.displacements:
        now = scheduled(drive_s, event)
        moved_m[now] += (event.east_m, event.north_m, 0.0)
    return moved_m


def _moved(truth: Truth, offsets_m: Floats) -> tuple[Floats, Floats]:
    """Latitudes and longitudes of the truth and an offset."""
    east_m, north_m = offsets_m[:, 0], offsets_m[:, 1]
    azimuths_deg = np.degrees(np.arctan2(east_m, north_m))
    lons_deg, lats_deg, _ = WGS84.fwd(
        truth.lons_deg, truth.lats_deg, azimuths_deg, np.hypot(east_m, north_m)
    )
    return np.asarray(lats_deg), np.asarray(lons_deg)


def _arrivals_s(timestamps_s: Floats, model: GpsModel, random: np.random.Generator) -> Floats:
    late_s = model.arrival_delay_s + random.exponential(model.arrival_jitter_s, len(timestamps_s))
    return np.maximum.accumulate(timestamps_s + late_s)


def _sent(fixes: Fixes, model: GpsModel, random: np.random.Generator) -> Fixes:
    """What of the fixes is sent: some are missing, some come again in place of the next."""
    count = len(fixes.valid)
    sent = np.flatnonzero(random.random(count) >= model.dropped_share)
    again = random.random(count)[sent] < model.repeated_share
    again[:1] = False
    source = sent[np.maximum.accumulate(np.where(again, 0, np.arange(len(sent))))]
    told = fixes._asdict() | {
        name: column[source] for name, column in fixes._asdict().items() if name != "view"
    }
    return Fixes(**told)._replace(arrivals_s=fixes.arrivals_s[sent], repeated=again)
