"""Pure: what `wayline evaluate tracking` found, as a program reads it."""

import msgspec

from wayline_evaluation.tracking.acquisition import Search
from wayline_evaluation.tracking.fll import Reading
from wayline_evaluation.tracking.lock import LockLost
from wayline_evaluation.tracking.spectra import Spectrum


class Jitter(msgspec.Struct, frozen=True, kw_only=True):
    """Equation 2 by both readings, T 0.01 s and F 1 (figure 1)."""

    cn0_dbhz: float
    bandwidth_hz: float
    inside_hz: float
    """The whole bracket under the root: the default."""
    outside_hz: float


class Dynamics(msgspec.Struct, frozen=True, kw_only=True):
    """What stresses the loops, three sigma, along the line of sight and by motion alone."""

    jerk_hzps2: float
    left_by_aid_hzps2: float
    aid_std_hz: float
    """What the aid claims, root mean square."""
    aid_error_hz: float
    """What it is off, root mean square."""


class Loop(msgspec.Struct, frozen=True, kw_only=True):
    """One loop, by the equations and by simulation."""

    name: str
    bandwidth_hz: float
    aided: bool
    stress_hz: float
    """Equation 3."""
    threshold_dbhz: float | None
    """Where equation 1 just holds, F 1."""
    lost: LockLost
    gained_db: float | None
    """By simulation, beside the loop that is told nothing."""


class Track(msgspec.Struct, frozen=True, kw_only=True):
    """A loop of figure 8."""

    name: str
    bandwidth_hz: float
    tracked_hz: tuple[float, ...]
    """Of one run, 50 values a second until lock is lost."""
    jitter_hz: float
    """Equation 2, F 1."""
    error_rms_hz: float
    """Over all runs while in lock."""
    lost_share: float
    locked_s: float
    """Median."""


class Figure8(msgspec.Struct, frozen=True, kw_only=True):
    """The carrier and what two loops make of it."""

    cn0_dbhz: float
    doppler_hz: tuple[float, ...]
    tracks: tuple[Track, ...]


class Figure9(msgspec.Struct, frozen=True, kw_only=True):
    """Spectra of the offset under low dynamics."""

    cn0_dbhz: float
    without: Spectrum
    aided: Spectrum
    power_db: float
    """How much less power the aided loop's offset has."""


class Acquisition(msgspec.Struct, frozen=True, kw_only=True):
    """One range beside the aid's."""

    search: Search
    gained_db: float | None
    """By the aid, each cell looked at as long."""
    gained_by_cells_db: float | None
    """Without what a signal loses at the edge of its cell."""
    gained_same_time_db: float | None
    """By the aid, if the time saved is spent on looking longer."""


class TrackingReport(msgspec.Struct, frozen=True, kw_only=True):
    """The whole study."""

    drive: str | None
    assumptions: dict[str, str]
    example_hz: dict[Reading, float]
    """Equation 2 at T 0.01 s, F 1, 1 Hz and 30 dB-Hz."""
    jitters: tuple[Jitter, ...]
    dynamics: Dynamics
    loops: tuple[Loop, ...]
    figure_8: Figure8
    figure_9: Figure9
    acquisition: tuple[Acquisition, ...]
