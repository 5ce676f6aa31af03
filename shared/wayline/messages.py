"""Pure: every message of the bus, one frozen Struct a topic. The only place that lists topics.

Units are in the names (SPEC sections 1 and 2). `None` is unknown. `t_ns` is Unix time in
nanoseconds of the measured or described instant.
"""

from typing import Annotated, ClassVar, Literal, get_type_hints

import msgspec
from msgspec import Meta

LatDeg = Annotated[float, Meta(ge=-90.0, le=90.0)]
LonDeg = Annotated[float, Meta(ge=-180.0, le=180.0)]
BearingDeg = Annotated[float, Meta(ge=0.0, lt=360.0)]
# What lies beyond is bad input, whoever sends it (SPEC section 2).
EARLIEST_NS = 315_532_800_000_000_000
"""1980, before any receiver of satellites."""
LATEST_NS = 4_102_444_800_000_000_000
"""2100."""
SPEED_MAX_MPS = 200.0
STD_MAX = 1e7
"""In metres, more than a quarter of the Earth's girth: nothing is known."""
TEXT_MAX = 256
QUANTITY_MAX = 1e9
"""Of whatever has no bound of its own, in its unit: a million kilometres, ten thousand bar."""
VARIANCE_MAX = STD_MAX**2
COUNT_MAX = 2**53
"""What a JSON number holds exactly, wherever it is read."""
LIST_MAX = 2_000
PAYLOAD_MAX_BYTES = 512 * 1024

Quantity = Annotated[float, Meta(ge=-QUANTITY_MAX, le=QUANTITY_MAX)]
NonNegative = Annotated[float, Meta(ge=0.0, le=QUANTITY_MAX)]
Positive = Annotated[float, Meta(gt=0.0, le=QUANTITY_MAX)]
Covariance = Annotated[float, Meta(ge=-VARIANCE_MAX, le=VARIANCE_MAX)]
Count = Annotated[int, Meta(ge=0, le=COUNT_MAX)]
Number = Annotated[int, Meta(ge=-COUNT_MAX, le=COUNT_MAX)]
TimeNs = Annotated[int, Meta(ge=EARLIEST_NS, le=LATEST_NS)]
Speed = Annotated[float, Meta(ge=0.0, le=SPEED_MAX_MPS)]
SignedSpeed = Annotated[float, Meta(ge=-SPEED_MAX_MPS, le=SPEED_MAX_MPS)]
Std = Annotated[float, Meta(ge=0.0, le=STD_MAX)]
ReceiverStd = Annotated[float, Meta(gt=0.0, le=STD_MAX)]
"""A receiver that claims 0 tells nothing."""
Carrier = Annotated[float, Meta(gt=0.0, le=1e11)]
"""Of radio, in Hz: beyond what other quantities may be."""
Text = Annotated[str, Meta(max_length=TEXT_MAX)]
AtMost = Meta(max_length=LIST_MAX)

FixKind = Literal[
    "none", "gps", "dgps", "rtk_float", "rtk_fixed", "dead_reckoning", "manual", "simulator"
]
PoseMode = Literal["starting", "gps", "fused", "dead_reckoning", "lost"]
Calibration = Literal["none", "started", "calibrated"]


class Message(msgspec.Struct, frozen=True, kw_only=True):
    """What every topic has: the instant, and (on the class) the topic's name and nominal rate."""

    topic: ClassVar[str]
    rate_hz: ClassVar[float]

    t_ns: TimeNs


class GpsFix(Message, frozen=True, kw_only=True):
    """One epoch of a positioning receiver; `valid` only with a valid latitude and longitude."""

    topic: ClassVar[str] = "gps_fix"
    rate_hz: ClassVar[float] = 1.0

    valid: bool
    lat_deg: LatDeg | None = None
    lon_deg: LonDeg | None = None
    alt_m: Quantity | None = None
    geoid_sep_m: Quantity | None = None
    speed_mps: Speed | None = None
    course_deg: BearingDeg | None = None
    mode: Literal[1, 2, 3] = 1
    fix: FixKind = "none"
    satellites: Count | None = None
    hdop: NonNegative | None = None
    pdop: NonNegative | None = None
    vdop: NonNegative | None = None
    h_std_m: ReceiverStd | None = None
    v_std_m: ReceiverStd | None = None
    speed_std_mps: ReceiverStd | None = None
    course_std_deg: ReceiverStd | None = None
    repeat: bool = False
    """The receiver sent its last fix again instead of a fresh one; then `valid` is false."""
    speed_derived: bool = False
    """The receiver tells no speed: this is the distance from its last fix over the time since."""
    assignment: Text | None = None
    """The trip or block that the report names, in its source's own words."""


class Satellite(msgspec.Struct, frozen=True, kw_only=True):
    """One satellite in view."""

    system: Text
    prn: Number
    elevation_deg: Quantity | None = None
    azimuth_deg: Quantity | None = None
    snr_dbhz: Quantity | None = None
    used: bool = False


class GpsSky(Message, frozen=True, kw_only=True):
    """The satellites in view."""

    topic: ClassVar[str] = "gps_sky"
    rate_hz: ClassVar[float] = 1.0

    satellites: Annotated[tuple[Satellite, ...], AtMost] = ()


class RawSatellite(msgspec.Struct, frozen=True, kw_only=True):
    """What a receiver measured of one satellite, and where that was; ECEF, at the transmission.

    The pseudorange is the way that the signal travelled with the receiver's clock in it, another
    offset for each system, less the satellite's clock: `clock_bias_m` is to be added; where that is
    None, nothing is left to add. The atmosphere's delay is taken out, but while nothing tells
    roughly where the receiver is. Place and motion are in the Earth-fixed frame of the instant of
    transmission: the Earth's turn while the signal travelled is left to the reader.
    """

    system: Text
    """gps, glonass, galileo, beidou, qzss, sbas, navic; each has a clock offset of its own."""
    prn: Number
    pseudorange_m: Quantity | None = None
    pseudorange_std_m: ReceiverStd | None = None
    """As the receiver claims it."""
    doppler_hz: Quantity | None = None
    """Positive when the satellite approaches."""
    doppler_std_hz: ReceiverStd | None = None
    cn0_dbhz: NonNegative | None = None
    carrier_hz: Carrier | None = None
    elevation_deg: Quantity | None = None
    azimuth_deg: Quantity | None = None
    line_of_sight: bool | None = None
    """Whether the signal came straight, where a data set tells: never read by a filter."""
    x_m: Quantity | None = None
    y_m: Quantity | None = None
    z_m: Quantity | None = None
    vx_mps: Quantity | None = None
    vy_mps: Quantity | None = None
    vz_mps: Quantity | None = None
    clock_bias_m: Quantity | None = None
    clock_drift_mps: Quantity | None = None


class GpsRaw(Message, frozen=True, kw_only=True):
    """One epoch of raw measurements."""

    topic: ClassVar[str] = "gps_raw"
    rate_hz: ClassVar[float] = 1.0

    satellites: Annotated[tuple[RawSatellite, ...], AtMost] = ()
    clock_reset: bool = False
    """The receiver has set its clock since the last epoch, mostly by whole milliseconds: all
    pseudoranges leapt together, by as many light milliseconds."""


class Odometer(Message, frozen=True, kw_only=True):
    """Wheel speed or distance as the vehicle measures it, before any scale is applied."""

    topic: ClassVar[str] = "odometer"
    rate_hz: ClassVar[float] = 10.0

    speed_mps: Speed | None = None
    distance_m: Quantity | None = None
    """Cumulative, wraps removed."""
    reverse: bool | None = None


class Gyro(Message, frozen=True, kw_only=True):
    """Yaw rate, positive clockwise (turning right), before bias and scale are applied."""

    topic: ClassVar[str] = "gyro"
    rate_hz: ClassVar[float] = 100.0

    yaw_rate_degps: Quantity | None = None
    temperature_c: Quantity | None = None


class Torque(Message, frozen=True, kw_only=True):
    """Engine and driveline; torque is net at the crankshaft, negative on the overrun."""

    topic: ClassVar[str] = "torque"
    rate_hz: ClassVar[float] = 10.0

    engine_torque_nm: Quantity | None = None
    engine_speed_rpm: NonNegative | None = None
    gear_ratio: Quantity | None = None
    gear: Number | None = None
    """0 neutral, -1 reverse."""
    brake: bool | None = None
    clutch: bool | None = None
    """True: the driveline is open."""
    slope_pct: Quantity | None = None
    """Where the vehicle itself reports one."""


class Barometer(Message, frozen=True, kw_only=True):
    """Air pressure at the vehicle."""

    topic: ClassVar[str] = "barometer"
    rate_hz: ClassVar[float] = 1.0

    pressure_pa: Positive | None = None
    temperature_c: Quantity | None = None


class Pose(Message, frozen=True, kw_only=True):
    """Fusion's estimate; every std is one sigma of the total error."""

    topic: ClassVar[str] = "pose"
    rate_hz: ClassVar[float] = 10.0

    mode: PoseMode
    lat_deg: LatDeg | None = None
    lon_deg: LonDeg | None = None
    alt_m: Quantity | None = None
    heading_deg: BearingDeg | None = None
    speed_mps: SignedSpeed | None = None
    """Negative in reverse."""
    yaw_rate_degps: Quantity | None = None
    grade_pct: Quantity | None = None
    distance_m: NonNegative = 0.0
    """Travelled since start, only grows."""
    east_std_m: Std | None = None
    north_std_m: Std | None = None
    east_north_cov_m2: Covariance | None = None
    heading_std_deg: Std | None = None
    speed_std_mps: Std | None = None
    alt_std_m: Std | None = None
    grade_std_pct: Std | None = None


class Verdict(msgspec.Struct, frozen=True, kw_only=True):
    """A gate's decision on one measurement: normalised innovation squared against its threshold."""

    sensor: Text
    t_ns: TimeNs
    accepted: bool
    nis: Annotated[float, Meta(ge=0.0)]
    """Without a bound: of a wild measurement it is as large as that is wild."""
    threshold: NonNegative
    reason: Text | None = None


class SensorSlope(msgspec.Struct, frozen=True, kw_only=True):
    """What one sensor alone says of the slope of the road just driven."""

    sensor: Text
    """As its verdicts name it."""
    source: Text | None = None
    """The receiver, of altitudes."""
    slope_pct: Quantity
    """In the direction of travel, positive uphill."""
    slope_std_pct: Std
    """By the scatter of its readings; what they share is not in it."""


class FusionStatus(Message, frozen=True, kw_only=True):
    """What fusion has learned of the sensors and what it did with their measurements.

    True rate = gyro_scale x (measured - gyro_bias_degps), true speed = odometer_scale x measured.
    """

    topic: ClassVar[str] = "fusion_status"
    rate_hz: ClassVar[float] = 1.0

    gyro_bias_degps: Quantity | None = None
    gyro_bias_std_degps: Std | None = None
    gyro_scale: Quantity | None = None
    gyro_scale_std: Std | None = None
    odometer_scale: Quantity | None = None
    odometer_scale_std: Std | None = None
    baro_bias_m: Quantity | None = None
    baro_bias_std_m: Std | None = None
    torque_bias_pct: Quantity | None = None
    torque_bias_std_pct: Std | None = None
    mass_kg: Positive | None = None
    mass_std_kg: Std | None = None
    gps_latency_s: Quantity | None = None
    gps_latency_std_s: Std | None = None
    calibration: Calibration = "none"
    outage_s: NonNegative = 0.0
    late: Count = 0
    rejected: Count = 0
    verdicts: Annotated[tuple[Verdict, ...], AtMost] = ()
    slopes: Annotated[tuple[SensorSlope, ...], AtMost] = ()
    """By sensor, over the last 200 m or less; those that have told enough of it."""


class AidedSatellite(msgspec.Struct, frozen=True, kw_only=True):
    """What a receiver's loops may expect of one satellite, with its std."""

    system: Text
    prn: Number
    doppler_hz: Quantity
    """Positive when the satellite approaches; the receiver clock's drift is in it where known."""
    doppler_std_hz: Std
    pseudorange_m: Quantity | None = None
    pseudorange_std_m: Std | None = None


class Aiding(Message, frozen=True, kw_only=True):
    """The vehicle's motion for a receiver's tracking loops (papers/001, tight coupling)."""

    topic: ClassVar[str] = "aiding"
    rate_hz: ClassVar[float] = 10.0

    satellites: Annotated[tuple[AidedSatellite, ...], AtMost] = ()
    clock_drift_mps: Quantity | None = None
    """Of the receiver's clock."""


class Progress(Message, frozen=True, kw_only=True):
    """Where the vehicle is along its route; latitude and longitude lie on the route."""

    topic: ClassVar[str] = "progress"
    rate_hz: ClassVar[float] = 1.0

    route_id: Text
    trip_id: Text | None = None
    distance_m: NonNegative
    lap: Count = 0
    lat_deg: LatDeg
    lon_deg: LonDeg
    cross_track_m: Quantity
    distance_std_m: Std
    on_route: bool
    speed_mps: SignedSpeed
    direction_id: Literal[0, 1] | None = None
    """Of the timetable's trip, as its feed numbers the two directions."""
    delay_s: float | None = None
    """Behind the timetable; negative is early. Null without one."""


class StopArrival(msgspec.Struct, frozen=True, kw_only=True):
    """The next arrival at one stop: median and the 10 and 90 % quantiles."""

    stop_id: Text
    name: Text
    distance_m: NonNegative
    arrival_ns: TimeNs
    early_ns: TimeNs
    late_ns: TimeNs
    departure_ns: TimeNs | None = None
    scheduled_ns: TimeNs | None = None
    """Of the arrival, by the timetable."""
    trip_id: Text | None = None
    """Where it is of a later trip than the one under way: of the same block."""
    confidence: Literal["learned", "timetable", "planned"] | None = None
    """What it rests on: travel times that were learned, a timetable's, a route's planned speeds."""
    stop_sequence: Count | None = None
    """The timetable's number of the stop within its trip; null without one."""


class TripRun(msgspec.Struct, frozen=True, kw_only=True):
    """A trip of a timetable on one day."""

    trip_id: Text
    route_id: Text
    direction_id: Literal[0, 1] | None = None
    start_date: Text
    """Its service day, as GTFS writes it: 20260131."""
    start_time: Text | None = None
    """Of a trip that is repeated (frequencies): when this time begins, 07:30:00."""
    exact: bool = True
    """Whether it is promised at its times; else only the time between two vehicles is."""


class Arrivals(Message, frozen=True, kw_only=True):
    """The next arrival at every stop of the route; empty while nothing can be predicted."""

    topic: ClassVar[str] = "arrivals"
    rate_hz: ClassVar[float] = 1.0

    route_id: Text
    trip_id: Text | None = None
    headsign: Text | None = None
    """Where the trip under way goes, as its vehicle shows."""
    stale: bool
    position_ns: TimeNs | None = None
    """Instant of the position that this rests on."""
    stops: Annotated[tuple[StopArrival, ...], AtMost] = ()
    runs: Annotated[tuple[TripRun, ...], AtMost] = ()
    """The timetable's trips that the stops are of: the one under way, then a later one."""


StopEventKind = Literal["arrived", "departed", "passed", "skipped"]
Disruption = Literal["breakdown", "detour"]


class StopEvent(Message, frozen=True, kw_only=True):
    """A vehicle came to a stop of its route and stood, left it, passed it or left it out."""

    topic: ClassVar[str] = "stop_event"
    rate_hz: ClassVar[float] = 0.05

    route_id: Text
    trip_id: Text | None = None
    stop_id: Text
    stop_sequence: Count
    """The timetable's; of a route without one its stops are counted from 1."""
    kind: StopEventKind
    scheduled_ns: TimeNs | None = None
    """By the timetable: of the departure where that is told, else of the arrival."""
    distance_m: NonNegative
    """Of the stop along the route."""
    lap: Count = 0
    interpolated: bool = False
    """The vehicle was not seen then: the instant is reckoned from what was seen before and after"""
    disruption: Disruption | None = None
    """Breakdown: on the way there, or at the stop, it took five times as long as usual and five
    minutes more; told when it leaves. Detour: the stop was left out, off the route."""


class HorizonPoint(msgspec.Struct, frozen=True, kw_only=True):
    """Slope at a distance ahead, from earlier runs; unknown is null, never 0."""

    distance_m: NonNegative
    grade_pct: Quantity | None = None
    grade_std_pct: Std | None = None
    alt_m: Quantity | None = None
    runs: Count = 0
    updated_ns: TimeNs | None = None


class Horizon(Message, frozen=True, kw_only=True):
    """The road ahead of the vehicle, as earlier runs knew it."""

    topic: ClassVar[str] = "horizon"
    rate_hz: ClassVar[float] = 1.0

    road_id: Text | None = None
    direction: Literal[1, -1] | None = None
    """Of travel: 1 along the road's stored line, -1 against it."""
    position_m: Quantity | None = None
    """Along the road's line from its start."""
    points: Annotated[tuple[HorizonPoint, ...], AtMost] = ()


class TripStop(msgspec.Struct, frozen=True, kw_only=True):
    """Where a vehicle stood on its way."""

    started_ns: TimeNs
    dwell_s: NonNegative
    lat_deg: LatDeg
    lon_deg: LonDeg


class Trip(Message, frozen=True, kw_only=True):
    """A trip of the vehicle, from its first move to its last, told when it has ended.

    A timetable's trip is another thing. Told again under its key where it went on after all.
    """

    topic: ClassVar[str] = "trip"
    rate_hz: ClassVar[float] = 0.01

    trip_key: Text
    """Of the vehicle and the start."""
    started_ns: TimeNs
    ended_ns: TimeNs
    distance_m: NonNegative
    distance_std_m: Std
    climb_m: NonNegative | None = None
    """All that it went up; what the altitude's error may be counts for nothing."""
    climb_std_m: Std | None = None
    moving_s: NonNegative
    max_speed_mps: Speed
    start_lat_deg: LatDeg | None = None
    start_lon_deg: LonDeg | None = None
    end_lat_deg: LatDeg | None = None
    end_lon_deg: LonDeg | None = None
    rejected: Count = 0
    """Measurements that were refused."""
    outage_s: NonNegative = 0.0
    """Without accepted fixes."""
    stops: Annotated[tuple[TripStop, ...], AtMost] = ()


class Missing(msgspec.Struct, frozen=True, kw_only=True):
    """Something that a service works with and lacks."""

    subject: Text
    """`router`, `input` for what it reads from the bus, `database`, or a source's name."""
    what: Text
    """What is wrong with it, for people."""
    since_ns: TimeNs


class Health(Message, frozen=True, kw_only=True):
    """How a service does. Lag is how long after its receipt a message is taken."""

    topic: ClassVar[str] = "health"
    rate_hz: ClassVar[float] = 1.0

    service: Text
    version: Text
    started_ns: TimeNs
    in_rate_hz: NonNegative = 0.0
    out_rate_hz: NonNegative = 0.0
    backlog: Count = 0
    dropped: Count = 0
    dropped_rate_hz: NonNegative = 0.0
    """Over the last ten seconds."""
    bad_input: Count = 0
    bad_input_rate_hz: NonNegative = 0.0
    """Over the last ten seconds."""
    lag_ms_p50: Quantity | None = None
    lag_ms_p99: Quantity | None = None
    detail: Text | None = None
    missing: Annotated[tuple[Missing, ...], AtMost] = ()
    """Empty where the service is ready."""
    recorded: bool = False
    """What this source publishes is a recording that is played, so its times may be old."""


MESSAGES: tuple[type[Message], ...] = (
    GpsFix,
    GpsSky,
    GpsRaw,
    Odometer,
    Gyro,
    Torque,
    Barometer,
    Pose,
    FusionStatus,
    Aiding,
    Progress,
    Arrivals,
    StopEvent,
    Horizon,
    Trip,
    Health,
)
TOPICS: dict[str, type[Message]] = {message.topic: message for message in MESSAGES}


def stale_after_s(message: type[Message]) -> float:
    """Seconds without a message after which a reader calls the topic stale."""
    return max(3.0 / message.rate_hz, 2.0)


def field_types(struct: type[msgspec.Struct]) -> dict[str, object]:
    """Type of every field, annotations resolved, in declaration order."""
    hints = get_type_hints(struct, include_extras=True)
    return {name: hints[name] for name in struct.__struct_fields__}
