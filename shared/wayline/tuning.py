"""Pure: every tunable of the estimators, with unit and reason, overridable by `[tuning]`."""

from typing import Annotated, Literal

from msgspec import Meta

from wayline.messages import LIST_MAX
from wayline.strict import Strict

Positive = Annotated[float, Meta(gt=0.0)]
Probability = Annotated[float, Meta(gt=0.0, lt=1.0)]
ArchitectureName = Literal["loose", "measurement", "uncoupled", "gps_only", "gps_only_modified"]

VerticalSensor = Literal["gps", "barometer", "torque", "vehicle"]


class Tuning(Strict, frozen=True, kw_only=True):
    """Defaults suit a car with a consumer receiver, wheel speed and a MEMS gyro."""

    # what a fix is worth
    good_satellites_min: int = 4
    """Fewer is a bad fix (papers/003)."""
    good_pdop_max: Positive = 8.0
    """More is a bad fix (papers/003)."""
    bad_gps_factor: Positive = 10.0
    """A bad fix's stds are this much larger; papers/003 all but ignores it."""
    gps_range_std_m: Positive = 3.0
    """User-equivalent range error: a std is this times the dilution of precision."""
    gps_position_std_m: Positive = 4.0
    """Per axis, for a receiver that reports neither std nor HDOP."""
    gps_position_std_floor_m: Positive = 2.0
    """Receivers claim less than they deliver."""
    gps_vertical_factor: Positive = 2.0
    """Altitude is this much worse than a horizontal axis where nothing else is known."""
    gps_altitude_std_floor_m: Positive = 3.0
    """Altitude errors wander; smaller claims would follow them."""

    # fusion, horizontal
    architecture: ArchitectureName = "loose"
    """The fixes calibrate the vehicle's sensors (papers/001). "measurement" does without fixes
    where a receiver tells raw measurements: each satellite corrects by itself, so two still help.
    For comparison: "uncoupled" reckons from the last fix by sensors as they read, "gps_only" and
    "gps_only_modified" are papers/003's filters without the vehicle's sensors, the latter with more
    noise where satellites or PDOP are bad."""
    gate_probability: Probability = 0.9999
    """Good measurements pass a gate this often."""
    relock_after_s: Positive = 180.0
    """Positions that are rejected and agree with each other are believed after as long as others
    were before them, and at the latest after this: one set of walls reflects for a minute or so."""
    relock_at_once_s: Positive = 5.0
    """Positions that are rejected and agree with each other are believed after this at the
    earliest."""
    relock_without_gyro_s: Positive = 8.0
    """Positions that are rejected and agree with each other are believed after this where no gyro
    tells of turns: what was reckoned goes straight on."""
    relock_after_outage_s: Positive = 25.0
    """Positions that are rejected and agree with each other are believed after this at the latest
    where an outage (`relock_outage_s`) came before: dead reckoning is the one to doubt."""
    relock_outage_s: Positive = 60.0
    """Dead reckoning is the one to doubt after an outage that lasted so long."""
    reacquire_probability: Probability = 0.99
    """After such an outage positions less likely than this wait to be confirmed: a receiver that
    has just found its satellites again may be hundreds of metres off."""
    course_relock_after_s: Positive = 5.0
    """Courses rejected this long without a break are believed: walls do not bend Doppler."""
    speed_relock_after_s: Positive = 10.0
    """Speeds of fixes rejected this long: the wheels' scale is another one (other tyres)."""
    wheels_relock_after_s: Positive = 1.5
    """Wheels that locked or spun are back after a second; a vehicle that hit something stands."""
    bias_relock_after_s: Positive = 2.0
    """A gyro that reads another rate at rest this long has another bias."""
    late_measurement_s: Positive = 1.0
    """Measurements up to this late are applied at their own time."""
    gps_error_time_s: Positive = 120.0
    """Correlation time of a receiver's position error: satellites and air change in minutes."""
    gps_error_share: Probability = 0.9
    """Share of a fix's variance that varies slowly; the rest is white."""
    gps_speed_std_mps: Positive = 0.1
    """Doppler per axis at a dilution of 1, of a receiver that reports no std; then learned."""
    gps_course_std_deg: Positive = 0.05
    """Floor of the course's std, for wind, camber and rounding."""
    gps_latency_std_s: Positive = 0.1
    """Before it is learned: latency of fixes beyond the configured one."""
    course_bias_std_deg: Positive = 2.0
    """Before it is learned: axles askew, a phone that lies askew, courses cut to tenths."""
    gps_time_std_s: Positive = 0.03
    """Jitter of that latency: turning, a course is off by this much time."""
    antenna_lever_m: Positive = 0.5
    """From the antenna to the rear axle, where the heading is the direction of travel."""
    course_speed_min_mps: Positive = 3.0
    """Course is noise at a crawl."""
    heading_start_std_deg: Positive = 20.0
    """The first course that sets the heading may be taken in a turn."""
    position_noise_m_per_sqrt_s: Positive = 0.18
    """Side slip, and what the model leaves out: courses that are cut to tenths of a degree are 2 m
    off at 20 m/s after two minutes."""
    acceleration_std_mps2: Positive = 0.7
    """Accelerations of cars under way: 0.4 on main roads, 0.7 in town."""
    acceleration_time_s: Positive = 5.0
    """Cars keep an acceleration for so long. Harder braking is noticed when it happens."""
    acceleration_max_mps2: Positive = 10.0
    """Tyres hold no more; wheels that change their speed faster have locked or spin."""
    acceleration_noise_mps_per_sqrt_s: Positive = 1.5
    """Where no acceleration is estimated, cars change speed by this much in a second."""
    gyro_noise_deg_per_sqrt_s: Positive = 0.01
    """Angle random walk of a MEMS gyro in a vehicle that vibrates, besides its steps."""
    turn_noise_deg_per_sqrt_s: Positive = 10.0
    """Without a gyro, headings change by this much in a second, at speed by less
    (`lateral_acceleration_std_mps2`)."""
    lateral_acceleration_std_mps2: Positive = 1.5
    """Without a gyro, headings change at speed by no more than this over the speed: curves are
    driven at up to 3."""
    gyro_bias_initial_std_degps: Positive = 1.0
    """A MEMS gyro from the box."""
    gyro_bias_walk_degps_per_sqrt_s: Positive = 0.0015
    """0.02 deg/s in three minutes; what this very gyro does is learned."""
    gyro_scale_initial_std: Positive = 0.02
    """Data sheets say 1 to 3 %."""
    gyro_scale_walk_per_sqrt_s: Positive = 1e-5
    """Temperature moves it by 0.1 % in hours."""
    odometer_scale_initial_std: Positive = 0.03
    """Speedometers read up to 5 % high, tyres wear 2 %."""
    odometer_scale_walk_per_sqrt_s: Positive = 3e-5
    """Tyres warm up: 0.1 % in 20 minutes."""
    odometer_std_mps: Positive = 0.08
    """Wheel speed besides its rounding."""
    standstill_after_s: Positive = 1.0
    """Wheels that have not turned this long stand; a coarse speed reads 0 at a crawl."""
    standstill_std_mps: Positive = 0.02
    """How still still is."""
    standstill_gyro_std_degps: Positive = 0.1
    """A tenth of a second of gyro at rest: noise, coarse steps, people getting in."""
    calibrated_bias_std_degps: Positive = 0.03
    """Bias known this well costs 10 m after 1 km at 20 m/s."""
    calibrated_scale_std: Positive = 0.005
    """Scale known this well costs 5 m after 1 km."""
    gyro_bias_switch_on_std_degps: Positive = 0.02
    """A gyro switched off and on has another bias, besides what warmth and time do to it."""
    gyro_bias_drift_degps_per_c: Positive = 0.01
    """Warmth changes a gyro's bias by this much."""
    parked_position_std_m: Positive = 30.0
    """A parked vehicle may have been moved, or driven off while its computer started."""
    parked_heading_std_deg: Positive = 3.0
    """A parked vehicle's heading may have changed, as its position."""

    # fusion, raw measurements (`architecture = "measurement"`)
    range_std_floor_m: Positive = 3.0
    """Of a strong signal from the zenith: orbits, clocks and air, which receivers do not count."""
    range_rate_std_floor_mps: Positive = 0.1
    """Receivers claim less."""
    reflection_time_s: Positive = 30.0
    """At rest reflections change over such a time: satellites move on..."""
    reflection_way_m: Positive = 15.0
    """...and under way over such a way: a house, a gap. Ranges between tell nothing new."""
    clock_noise_m_per_sqrt_s: Positive = 0.3
    """Of the receiver's clock, white frequency noise."""
    clock_drift_walk_mps_per_sqrt_s: Positive = 0.05
    """Crystals warm up and are shaken."""
    slope_std_pct: Positive = 3.0
    """Roads climb by this much where nobody tells. The height known stands in for a satellite..."""
    slope_length_m: Positive = 200.0
    """...as long as a slope that goes on for so far lets it."""

    # fusion, vertical
    vertical_sensors: tuple[VerticalSensor, ...] = ("gps", "barometer", "torque", "vehicle")
    """Each can be run alone, as papers/004 does, or with any others; `vehicle` is the slope that
    the vehicle itself reports."""
    slope_initial_std_pct: Positive = 4.0
    """Roads are rarely steeper than 8 %."""
    curvature_std_pct_per_m: Positive = 0.016
    """Of roads: 1 % of slope in 60 m, between straight slopes and short vertical curves."""
    curvature_length_m: Positive = 60.0
    """Over which a vertical curve goes on."""
    baro_bias_initial_std_m: Positive = 150.0
    """Weather: 1013 hPa plus or minus 20."""
    baro_bias_walk_m_per_sqrt_s: Positive = 0.1
    """Weather and ventilation: 0.8 m in a minute, 6 m in an hour."""
    baro_std_m: Positive = 0.5
    """Noise of a barometer besides its resolution."""
    baro_resolution_std_max_m: Positive = 5.0
    """Coarser barometers say nothing of the road."""
    baro_relock_after_s: Positive = 10.0
    """Pressures rejected this long: a window was opened; a tunnel's gust is over sooner."""
    gps_altitude_error_time_s: Positive = 120.0
    """Correlation time of an altitude error: between reflections (a minute) and the air (more)."""
    gps_altitude_error_share: Probability = 0.9
    """Share of an altitude's variance that varies slowly; the rest is white."""

    torque_std_pct: Positive = 0.15
    """Of a slope by a second of torque, white, before it is learned: whole percents of torque, the
    driveline. What acceleration takes is measured by the wheels, whose noise is learned apart."""
    torque_bias_std_pct: Positive = 0.3
    """Of a slope by torque, slowly varying: wind, rolling, fan and generator."""
    torque_bias_time_s: Positive = 220.0
    """Correlation time of that: fans and compressors come and go in a minute, the road turns into
    the wind in some."""
    torque_relock_after_s: Positive = 20.0
    """Torques rejected this long: the mass is another one."""
    mass_std_share: Positive = 0.1
    """Of the mass that the vehicle is said to have, and of the engine's torque."""
    vehicle_slope_std_pct: Positive = 0.5
    """Of a second of the vehicle's own slope, white."""
    vehicle_slope_bias_std_pct: Positive = 0.4
    """Of the vehicle's own slope: like torque, and the mass that the vehicle believes."""

    # eta
    route_filter: Literal["default", "avl"] = "default"
    """`avl` is the published filter of papers/000, kept as a reference."""
    off_route_m: Positive = 60.0
    """Twice farther from the route than this is a detour (as transit systems have it)."""
    on_route_m: Positive = 40.0
    """Twice within this of the route ends a detour."""
    stop_radius_m: Positive = 10.0
    """A vehicle that stands this near to a stop has arrived (SPEC section 8)."""
    eta_standing_mps: Positive = 0.5
    """Slower is standing."""
    eta_moving_mps: Positive = 2.0
    """Faster is under way: the heading is to be believed, and a dwell is over."""
    eta_stale_after_s: Positive = 5.0
    """Arrivals from a position older than this are marked stale."""
    eta_forget_after_s: Positive = 360.0
    """Nothing is predicted from a position older than this (as transit systems have it)."""

    # slope map
    map_bin_m: Annotated[float, Meta(ge=1.0, le=100.0)] = 20.0
    """Length of a new road's bins; papers/004 section 5.5 finds 20 m enough for main roads."""
    map_gps_std_max_m: Positive = 20.0
    """A worse altitude (cold start, poor dilution) says nothing of the slope."""
    map_grade_std_max_pct: Positive = 5.0
    """A bin known worse by a run is not learned from it."""
    map_position_std_max_m: Positive = 25.0
    """A pose known worse is not placed on a road."""
    map_run_max_m: Positive = 50_000.0
    """A run this long is merged though the drive goes on."""
    map_park_s: Positive = 300.0
    """A vehicle that stands this long is parked: its run is merged. Queues are shorter."""
    map_gap_s: Positive = 60.0
    """A silence this long ends a run."""
    horizon_length_m: Positive = 2000.0
    """How far the horizon looks."""
    horizon_step_m: Positive = 20.0
    """Between the points of the horizon."""

    def __post_init__(self) -> None:
        points = self.horizon_length_m / self.horizon_step_m + 1.0
        if points > LIST_MAX:
            raise ValueError(
                f"horizon_length_m over horizon_step_m makes {points:,.0f} points, more than "
                f"{LIST_MAX:,}"
            )
