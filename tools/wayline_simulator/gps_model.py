"""Pure: what kind of GPS receiver a vehicle has."""

from typing import Annotated, Literal

from msgspec import Meta

from wayline.strict import Strict
from wayline_simulator.constellation import System

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
Rate = Annotated[float, Meta(gt=0.0, le=10.0)]
SentenceKind = Literal["RMC", "GGA", "GSA", "GSV", "GST", "VTG", "ZDA"]


class GpsModel(Strict, frozen=True, kw_only=True):
    """`[gps]`: a receiver. Stds are one sigma per axis at a dilution of precision of 1.

    The defaults are a receiver of today with a patch antenna. "css-164" below is measured on the
    car of that recording, "Munich" on the receiver of nmea/munich; docs/simulator.md compares.
    """

    rate_hz: Rate = 1.0
    systems: Annotated[tuple[System, ...], Meta(min_length=1)] = ("gps", "glonass")
    """Usual since u-blox M8 (data sheet: concurrent reception); Munich's hears GPS alone."""
    position_white_std_m: NotNegative = 0.05
    """Receivers filter: third differences of positions give 0.04 m (css-164) and 0.12 m (Munich, at
    an HDOP of 2.4), the vehicle's own jerk and the rounding included."""
    position_wander_std_m: NotNegative = 2.0
    """Of a first-order Gauss-Markov error: satellites' orbits and clocks, the air, reflections.
    Under an open sky (HDOP 0.6) half of the fixes are within 1.5 m; data sheet of u-blox M8: 2.5 m
    CEP, the slow error of a whole day included; css-164 reports a std of 1 m."""
    position_wander_time_s: Positive = 120.0
    """A judgement between reflections (tens of seconds) and the air (tens of minutes); css-164
    drifts by 0.4 to 0.7 m (std) within 13 to 21 s of standing, this by 0.2 to 0.5."""
    altitude_white_std_m: NotNegative = 0.08
    """css-164: 0.07 m by third differences, in steps of 0.1 m; Munich: 0.13 m at a VDOP of 3.9."""
    altitude_wander_std_m: NotNegative = 2.5
    """On top, VDOP is 1.3 to 1.6 times HDOP: the whole is about twice the error of a horizontal
    axis, which is the usual rule; papers/004 section 3.1 speaks of 3 to 4 times."""
    altitude_wander_time_s: Positive = 120.0
    smoothing_time_s: NotNegative = 0.0
    """First-order lag of the altitude, truth and error alike: the filter inside the receiver of
    papers/004 (section 5.2.3). The horizontal position has none: Doppler carries it along."""
    velocity_std_mps: NotNegative = 0.05
    """Doppler, per horizontal axis; speed and course are both made of it. Data sheet of u-blox M8:
    0.05 m/s in half of the cases; css-164: 0.04 by third differences of its speed."""
    velocity_rest_std_mps: NotNegative = 0.012
    """Doppler at rest, per horizontal axis: css-164's median speed is then 0.010 to 0.014 m/s."""
    course_min_mps: NotNegative = 0.5
    """At lower speeds the receiver knows no course; Munich's is blank below 1 to 2 km/h."""
    course_at_rest: Literal["blank", "held"] = "blank"
    """css-164's holds its last one."""
    latency_s: NotNegative = 0.0
    """A fix describes the vehicle this long before its own timestamp; css-164: 0.35."""
    arrival_delay_s: NotNegative = 0.12
    """From a fix's timestamp until its first sentence: computing time. A judgement."""
    arrival_jitter_s: NotNegative = 0.01
    """Mean of what comes on top, exponentially distributed."""
    baud_bps: Positive = 38_400.0
    """Of the serial line: sentences follow each other as it lets them."""
    mask_deg: NotNegative = 5.0
    """Satellites lower than this are not used: u-blox M8's default (UBX-CFG-NAV5)."""
    pdop_max: Positive = 25.0
    """No fix at a worse geometry: u-blox M8's default (UBX-CFG-NAV5). Munich's goes to 150."""
    first_fix_s: NotNegative = 0.0
    """Cold start: nothing is known before. Data sheet of u-blox M8: 26 s under an open sky;
    css-164, driving: 129 s."""
    first_error_m: NotNegative = 0.0
    """Std of the position error that a cold start begins with; altitude three times as bad.
    css-164: altitude off by 72 m, its receiver reports stds of 36 and 92 m."""
    first_error_time_s: Positive = 12.0
    """Time in which a cold start's error falls to a third (css-164)."""
    reacquire_s: NotNegative = 1.5
    """Time to a fix after the sky is seen again, on average; data sheet of u-blox M8: 1 s."""
    reacquire_error_m: NotNegative = 4.0
    """Std of what the first fix after a long blindness has on top. A judgement."""
    reacquire_error_time_s: Positive = 5.0
    """Time in which the error after a long blindness falls to a third. A judgement."""
    reported_std_factor: Positive = 1.0
    """The stds in GST are the true ones times this."""
    reflection_std_m: NotNegative = 30.0
    """Root mean square of the offsets in a canyon, which HDOP does not show: most are 15 to
    60 m. In an ordinary street a tenth."""
    reflection_time_s: Positive = 40.0
    """How long one set of reflections lasts, on average: most 20 to 90 s."""
    dropped_share: Share = 0.0
    """Fixes that are missing; css-164: 0.02."""
    repeated_share: Share = 0.0
    """Fixes that repeat the one before, time included; papers/000: 2 to 3 in every 29 s."""
    minute_decimals: Annotated[int, Meta(ge=3, le=7)] = 5
    """Of latitude and longitude in sentences; 4 are 0.19 m (Munich), 3 are 1.9 m (Garmin Geko)."""
    sentences: tuple[SentenceKind, ...] = (
        "RMC",
        "GGA",
        "GSA",
        "GSV",
        "GST",
    )
    """In the order of the receiver."""
