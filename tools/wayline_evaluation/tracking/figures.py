"""Pure: figures 1, 8 and 9 of papers/001 as numbers, and the search that an aid spares."""

import math

import msgspec
import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_evaluation.tracking.acquisition import (
    SIGMAS,
    SearchModel,
    cells_only_db,
    search,
)
from wayline_evaluation.tracking.aid import AidModel, aid_of
from wayline_evaluation.tracking.fll import (
    Reading,
    ratio_hz,
    thermal_jitter_hz,
)
from wayline_evaluation.tracking.loop import PAIR_S, Complexes, Told, frequency_errors_hz, in_lock
from wayline_evaluation.tracking.motion import (
    LOW_DYNAMICS,
    WAVELENGTH_M,
    doppler_hz,
    random_motions,
)
from wayline_evaluation.tracking.printed import FIGURE_8_DBHZ, FIGURE_8_HZ, UNAIDED_HZ
from wayline_evaluation.tracking.report import Acquisition, Figure8, Figure9, Jitter, Track
from wayline_evaluation.tracking.spectra import spectrum_of

READINGS: tuple[Reading, ...] = ("inside", "outside")
EXAMPLE_HZ, EXAMPLE_DBHZ = 1.0, 30.0
FAMILY_DBHZ = (20.0, 25.0, 30.0, 35.0, 40.0)
FAMILY_HZ = tuple(np.round(np.arange(0.1, 2.01, 0.1), 1).tolist())
FIGURE_9_DBHZ = 30.0
SHOWN = 0
"""The run that figure 8 shows."""
SPEED_HZ = 40.0 / WAVELENGTH_M
"""A vehicle whose velocity is not known moves at up to 40 m/s."""
CLOCK_HZ = 0.5e-6 * 1_575.42e6
"""A clock whose drift is not known is off by up to 0.5 ppm."""


def thermal_example_hz() -> dict[Reading, float]:
    """Equation 2 by both readings where the paper's table has figures to compare."""
    cn0_hz = ratio_hz(EXAMPLE_DBHZ)
    return {each: thermal_jitter_hz(EXAMPLE_HZ, cn0_hz, reading=each) for each in READINGS}


def family() -> tuple[Jitter, ...]:
    """Figure 1's curves."""
    return tuple(
        Jitter(
            cn0_dbhz=level,
            bandwidth_hz=bandwidth_hz,
            inside_hz=thermal_jitter_hz(bandwidth_hz, ratio_hz(level)),
            outside_hz=thermal_jitter_hz(bandwidth_hz, ratio_hz(level), reading="outside"),
        )
        for level in FAMILY_DBHZ
        for bandwidth_hz in FAMILY_HZ
    )


def figure_8(doppler: Floats, aid_hz: Floats, noise: Complexes) -> Figure8:
    """Carriers and aids of shape (samples, runs), tracked at 10 dB-Hz."""
    wide_hz, narrow_hz = FIGURE_8_HZ
    tracks = (
        _track("told nothing", wide_hz, Told(doppler, np.zeros_like(doppler)), noise),
        _track("aided", wide_hz, Told(doppler, aid_hz), noise),
        _track("aided", narrow_hz, Told(doppler, aid_hz), noise),
    )
    shown_hz = doppler[:, SHOWN]
    middles_hz = 0.5 * (shown_hz[0::2] + shown_hz[1::2])
    return Figure8(cn0_dbhz=FIGURE_8_DBHZ, doppler_hz=tuple(middles_hz.tolist()), tracks=tracks)


def _track(name: str, bandwidth_hz: float, told: Told, noise: Complexes) -> Track:
    levels = np.array([ratio_hz(FIGURE_8_DBHZ)])
    errors_hz = frequency_errors_hz(told, bandwidth_hz, levels, noise)[:, 0]
    locked = in_lock(errors_hz)
    shown_hz, shown = told.doppler_hz[:, SHOWN], locked[:, SHOWN]
    tracked_hz = 0.5 * (shown_hz[0::2] + shown_hz[1::2]) - errors_hz[:, SHOWN]
    return Track(
        name=name,
        bandwidth_hz=bandwidth_hz,
        tracked_hz=tuple(tracked_hz[shown].tolist()),
        jitter_hz=thermal_jitter_hz(bandwidth_hz, ratio_hz(FIGURE_8_DBHZ)),
        error_rms_hz=float(np.sqrt(np.mean(np.square(errors_hz[locked])))),
        lost_share=float(np.mean(~locked[-1])),
        locked_s=float(np.median(np.sum(locked, axis=0))) * PAIR_S,
    )


def figure_9(
    narrow_hz: float, model: AidModel, noise: Complexes, random: np.random.Generator
) -> Figure9:
    """The offset's spectrum at 1.2 Hz without an aid, and at the bandwidth that one allows."""
    samples, runs = noise.shape
    motions = random_motions(LOW_DYNAMICS, samples, runs, random)
    signal_hz = doppler_hz(motions)
    aid = aid_of(motions, model, random)
    levels = np.array([ratio_hz(FIGURE_9_DBHZ)])
    without, aided = (
        spectrum_of(frequency_errors_hz(told, bandwidth_hz, levels, noise)[:, 0], bandwidth_hz)
        for told, bandwidth_hz in (
            (Told(signal_hz, np.zeros_like(signal_hz)), UNAIDED_HZ),
            (Told(signal_hz, aid.doppler_hz), narrow_hz),
        )
    )
    return Figure9(
        cn0_dbhz=FIGURE_9_DBHZ,
        without=without,
        aided=aided,
        power_db=10.0 * math.log10(without.power_hz2 / aided.power_hz2),
    )


def acquisition(aid_std_hz: float, model: SearchModel) -> tuple[Acquisition, ...]:
    """Ranges without an aid, then the aid's."""
    aided = search("aided, three stds", SIGMAS * aid_std_hz, model)
    wide = (
        search("velocity and clock not known", SPEED_HZ + CLOCK_HZ, model),
        search("velocity not known", SPEED_HZ, model),
    )
    rows = []
    for each in wide:
        longer = round(model.correlations * each.cells / aided.cells)
        patient = msgspec.structs.replace(model, correlations=longer)
        same_time = search("", SIGMAS * aid_std_hz, patient)
        rows.append(
            Acquisition(
                search=each,
                gained_db=each.needed_dbhz - aided.needed_dbhz,
                gained_by_cells_db=cells_only_db(each, aided, model),
                gained_same_time_db=each.needed_dbhz - same_time.needed_dbhz,
            )
        )
    nothing = Acquisition(
        search=aided, gained_db=None, gained_by_cells_db=None, gained_same_time_db=None
    )
    return (*rows, nothing)
