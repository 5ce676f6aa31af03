"""Pure: Dopplers that a receiver was told, beside those that it should have measured.

What should have been measured is reckoned from the truth's place and motion, the satellites' orbits
of the epoch and the clock that its Dopplers have in common: a simulated receiver's own noise is no
error of what it was told.
"""

from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np

from wayline.messages import Aiding, GpsRaw
from wayline.satellites.clock import shared_part
from wayline.satellites.doppler import AntennaMotion, antenna_of, expected
from wayline_evaluation.estimates import Floats
from wayline_evaluation.reference import Reference
from wayline_fusion.coupling.heard import heard_of, placed

LEAST = 4
"""Satellites of an epoch whose Dopplers tell the clock well enough."""
SUDDEN_NS = 50_000_000
"""An aid this near to an epoch is held against it."""


class Predicted(msgspec.Struct, frozen=True, kw_only=True):
    """Of all satellites in line of sight, Hz."""

    count: int
    rms_hz: float
    p95_hz: float
    std_hz: float
    """As told, root mean square."""
    in_two_std: float
    still_rms_hz: float
    """The error of who is told all but the vehicle's velocity."""


class Errors(NamedTuple):
    """A row a satellite and epoch, shape (n,)."""

    times_s: Floats
    """Unix."""
    off_hz: Floats
    stds_hz: Floats
    still_hz: Floats


def predicted(errors: Errors, rows: np.ndarray) -> Predicted | None:
    """Figures of some rows; None without any."""
    off_hz, stds_hz = np.abs(errors.off_hz[rows]), errors.stds_hz[rows]
    if len(off_hz) == 0:
        return None
    return Predicted(
        count=len(off_hz),
        rms_hz=_rms(off_hz),
        p95_hz=float(np.percentile(off_hz, 95.0)),
        std_hz=_rms(stds_hz),
        in_two_std=float(np.mean(off_hz <= 2.0 * stds_hz)),
        still_rms_hz=_rms(errors.still_hz[rows]),
    )


def errors_of(aids: Sequence[Aiding], epochs: Sequence[GpsRaw], truth: Reference) -> Errors:
    """Aids in order of time, held against the epochs that were measured as they came."""
    aids_ns = np.array([aid.t_ns for aid in aids], dtype=np.int64)
    rows: list[tuple[float, float, float, float]] = []
    for epoch in epochs:
        at = int(np.searchsorted(aids_ns, epoch.t_ns - SUDDEN_NS))
        if at < len(aids) and aids[at].t_ns <= epoch.t_ns + SUDDEN_NS:
            rows += _of_epoch(aids[at], epoch, truth)
    return Errors(*np.array(rows, dtype=np.float64).reshape(-1, 4).T)


def _of_epoch(
    aid: Aiding, epoch: GpsRaw, truth: Reference
) -> list[tuple[float, float, float, float]]:
    there, now = (_motion(truth, t_ns) for t_ns in (epoch.t_ns, aid.t_ns))
    measured = [each for each in placed(epoch) if each.doppler_hz is not None]
    if there is None or now is None or len(measured) < LEAST:
        return []
    heard = heard_of(measured, epoch.t_ns)
    rates_mps = expected(antenna_of(there), heard.orbits, epoch.t_ns).rates_mps
    dopplers_hz = np.array([each.doppler_hz for each in measured])
    off_mps = dopplers_hz / heard.hz_per_mps - (rates_mps - heard.clock_drifts_mps)
    noise = np.array([each.doppler_std_hz or 1.0 for each in measured]) / heard.hz_per_mps
    seen = expected(antenna_of(now), heard.orbits, aid.t_ns)
    drift_mps = shared_part(off_mps, np.square(noise), seen.by_axes, np.zeros(3)).value
    still = expected(antenna_of(now._replace(speed_mps=0.0)), heard.orbits, aid.t_ns)
    true_hz = heard.hz_per_mps * (seen.rates_mps + drift_mps - heard.clock_drifts_mps)
    still_hz = heard.hz_per_mps * (still.rates_mps - seen.rates_mps)
    told = {(each.system, each.prn): each for each in aid.satellites}
    rows = []
    for satellite, name, doppler_hz, off_still in zip(
        measured, heard.names, true_hz.tolist(), still_hz.tolist(), strict=True
    ):
        if name in told and satellite.line_of_sight is not False:
            off_hz, std_hz = told[name].doppler_hz - doppler_hz, told[name].doppler_std_hz
            rows.append((aid.t_ns * 1e-9, off_hz, std_hz, off_still))
    return rows


def _motion(truth: Reference, t_ns: int) -> AntennaMotion | None:
    """The true one; None outside the truth, or where it tells no heading or speed."""
    here = truth.at(np.array([t_ns * 1e-9]))
    columns = (here.lats_deg, here.lons_deg, here.headings_deg, here.speeds_mps)
    lat_deg, lon_deg, heading_deg, speed_mps = (float(column[0]) for column in columns)
    if np.isnan([lat_deg, lon_deg, heading_deg, speed_mps]).any():
        return None
    alt_m, grade_pct = (float(np.nan_to_num(each[0])) for each in (here.alts_m, here.grades_pct))
    return AntennaMotion(
        lat_deg,
        lon_deg,
        height_m=alt_m,
        heading_deg=heading_deg,
        speed_mps=speed_mps,
        grade_pct=grade_pct,
        place_std_m=0.0,
        heading_std_deg=0.0,
        speed_std_mps=0.0,
        grade_std_pct=0.0,
    )


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
