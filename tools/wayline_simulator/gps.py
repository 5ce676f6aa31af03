"""Pure: what a GPS receiver measures: where it errs, when it is blind, how it is late."""

from typing import Annotated

from msgspec import Meta

from wayline.toml import Strict

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]


class GpsModel(Strict, frozen=True, kw_only=True):
    """`[gps]`: a receiver. Stds are one sigma per axis at a dilution of precision of 1."""

    rate_hz: Positive = 1.0
    position_white_std_m: NotNegative = 0.5
    position_wander_std_m: NotNegative = 1.5
    """Of a first-order Gauss-Markov error: satellites' orbits and clocks, the air, reflections."""
    position_wander_time_s: Positive = 120.0
    altitude_white_std_m: NotNegative = 0.6
    altitude_wander_std_m: NotNegative = 2.0
    altitude_wander_time_s: Positive = 120.0
    velocity_std_mps: NotNegative = 0.08
    """Doppler, per horizontal axis; speed and course are both made of it."""
    latency_s: NotNegative = 0.0
    """A fix describes the vehicle this long before its own timestamp."""
    arrival_delay_s: NotNegative = 0.12
    """From a fix's timestamp until its first sentence."""
    arrival_jitter_s: NotNegative = 0.01
    mask_deg: NotNegative = 8.0
    """Satellites lower than this are not used."""
    first_fix_s: NotNegative = 0.0
    """Cold start: nothing is known before."""
    first_error_m: NotNegative = 0.0
    """Std of the position error that a cold start begins with; altitude three times as bad."""
    first_error_time_s: Positive = 12.0
    """In which it falls to a third."""
    reacquire_s: NotNegative = 1.5
    """After the sky is seen again, on average."""
    reported_std_factor: Positive = 1.0
    """The stds in GST are the true ones times this."""
    reflection_std_m: NotNegative = 30.0
    """Of the offsets in a canyon, which HDOP does not show."""
    reflection_time_s: Positive = 40.0
    """How long one set of reflections lasts, on average."""
    dropped_share: Share = 0.0
    """Fixes that are missing."""
    repeated_share: Share = 0.0
    """Fixes that repeat the one before, time included."""
    sentences: tuple[str, ...] = ("RMC", "GGA", "GSA", "GSV", "GST")
    """In the order of the receiver."""
