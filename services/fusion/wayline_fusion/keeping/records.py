"""Pure: what fusion keeps of a vehicle over a restart."""

import msgspec

from wayline.core import Record


class SensorCalibration(msgspec.Struct, frozen=True, kw_only=True):
    """What was learned of the vehicle's sensors; `fusion_status` says what each number means."""

    gyro_bias_degps: float
    gyro_bias_std_degps: float
    gyro_scale: float
    gyro_scale_std: float
    odometer_scale: float
    odometer_scale_std: float
    gps_latency_s: float
    gps_latency_std_s: float
    correlations: tuple[float, ...]
    """Of bias, gyro scale, odometer scale and latency: first with second, first with third, first
    with fourth, second with third and so on."""
    gyro_temperature_c: float | None = None
    """While the bias was learned, where the bus tells it."""
    position_noise_factor: float = 1.0
    """Of the white variance that the receiver claims for its positions."""
    velocity_noise_factor: float = 1.0
    """Of the variance that the receiver claims, or is configured to have, for its Doppler."""
    bias_wander_factor: float = 1.0
    """Of the square of the configured walk of the gyro's bias."""
    pressure_noise_factor: float = 1.0
    """Of the variance that steps and weather are taken to give a pressure: wind, a fan, a door."""
    torque_noise_factor: float = 1.0
    """Of the variance that is configured for a slope by torque."""
    vehicle_slope_noise_factor: float = 1.0
    """Of the variance that is configured for a slope that the vehicle reports."""


class LastPose(msgspec.Struct, frozen=True, kw_only=True):
    """Where the vehicle was, and how it moved."""

    lat_deg: float
    lon_deg: float
    east_std_m: float
    north_std_m: float
    heading_deg: float
    heading_std_deg: float
    speed_mps: float
    """Negative in reverse."""
    fix_ns: int
    """When a fix was last accepted."""


class LastHeight(msgspec.Struct, frozen=True, kw_only=True):
    """How high the vehicle was, how steep the road, what the barometer was off and the load."""

    alt_m: float
    alt_std_m: float
    grade_pct: float
    grade_std_pct: float
    baro_bias_m: float
    baro_bias_std_m: float
    alt_bias_correlation: float
    """Of altitude and bias: what the barometer measures is their sum."""
    inverse_mass: float | None = None
    """Stated mass over the one that torque tells; None of what was kept before masses were."""
    inverse_mass_std: float | None = None


class Saved(Record, frozen=True, kw_only=True):
    """All that is kept of one vehicle, as of an instant of measurement time."""

    t_ns: int
    calibration: SensorCalibration
    pose: LastPose | None = None
    """None before position and heading were known."""
    height: LastHeight | None = None
    """None before an altitude was known."""
