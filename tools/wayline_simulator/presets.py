"""Pure: sets of sensors by name, each as some kind of vehicle has them."""

from wayline.strict import Strict
from wayline_simulator.barometer import BarometerModel
from wayline_simulator.gps import GpsModel
from wayline_simulator.gyro import GyroModel
from wayline_simulator.odometer import OdometerModel
from wayline_simulator.torque import TorqueModel


class Preset(Strict, frozen=True, kw_only=True):
    """A vehicle's sensors; None: it has no such one."""

    gps: GpsModel | None = None
    gyro: GyroModel | None = None
    odometer: OdometerModel | None = None
    torque: TorqueModel | None = None
    barometer: BarometerModel | None = None


KMH_MPS = 1.0 / 3.6

CONSUMER = Preset(
    # a phone's or dash camera's antenna behind the windscreen: judgement
    gps=GpsModel(
        position_white_std_m=0.8,
        position_wander_std_m=2.5,
        altitude_white_std_m=1.0,
        altitude_wander_std_m=3.5,
        velocity_std_mps=0.15,
        latency_s=0.2,
        arrival_delay_s=0.15,
        reported_std_factor=0.7,
    ),
    gyro=GyroModel(),
    odometer=OdometerModel(),
)
"""A car's stability control on the bus, and a consumer's receiver."""

MEMS = Preset(
    gps=GpsModel(),
    gyro=GyroModel(bias_wander_std_degps=0.02),
    odometer=OdometerModel(),
    torque=TorqueModel(),
    barometer=BarometerModel(),
)
"""A telematics unit of automotive grade; the bias wander of 0.02 deg/s is a judgement."""

CHEAP = Preset(
    gps=GpsModel(
        position_white_std_m=1.0,
        position_wander_std_m=2.5,
        altitude_white_std_m=1.5,
        altitude_wander_std_m=4.0,
        velocity_std_mps=0.2,
        latency_s=0.2,
    ),
    # three times the wander of MEMS; the MPU-6050's untrimmed scale is within 3 %
    gyro=GyroModel(
        bias_std_degps=1.0,
        bias_wander_std_degps=0.06,
        bias_wander_time_s=300.0,
        bias_per_kelvin_degps=0.02,
        scale_std=0.015,
        noise_deg_per_sqrt_s=0.02,
        resolution_degps=0.05,
    ),
    odometer=OdometerModel(noise_mps=0.05, resolution_mps=0.05, dead_zone_mps=0.8),
    torque=TorqueModel(gain_std=0.04, gain_wander_std=0.02, noise_pct=1.0),
    barometer=BarometerModel(wander_std_pa=20.0, noise_pa=6.0, resolution_pa=10.0),
)
"""A retrofitted box with the cheapest of everything; values without a source are judgements."""

THESIS = Preset(
    # papers/004 section 3.1: 4 m CEP, which is 3.4 m an axis; SiRF receivers send no GST. Errors of
    # the altitude that stay over a drive, which make it 3 to 4 times worse, do not touch the slope
    # and are left out; what wanders is set by the spread of table 5.1, filtered as in section 5.2.3
    gps=GpsModel(
        position_white_std_m=0.4,
        position_wander_std_m=3.4,
        position_wander_time_s=300.0,
        altitude_white_std_m=0.7,
        altitude_wander_std_m=1.2,
        altitude_wander_time_s=40.0,
        smoothing_time_s=2.0,
        reflection_std_m=0.0,
        reacquire_error_m=1.0,
        velocity_std_mps=0.1,
        latency_s=0.5,
        sentences=("GGA", "GSA", "RMC", "GSV"),
    ),
    # SAE J1939-71: SPN 84 in steps of 1/256 km/h ten times a second, SPN 917 in steps of 5 m
    odometer=OdometerModel(
        scale_std=0.01,
        noise_mps=0.03,
        resolution_mps=KMH_MPS / 256.0,
        dead_zone_mps=0.5,
        counter_resolution_m=5.0,
        counter_bits=32,
    ),
    # section 3.3: 10 Hz, 13 % while braking; the accessories' share by the spread of table 5.1
    torque=TorqueModel(slope_reported=True, offset_wander_std_pct=2.9),
    # section 3.2: 1 Hz, 50 Pa a bit, behind the dash board; the MPXA6115A's data sheet allows an
    # error of 1.5 % of its span, 1500 Pa, taken as three sigma. Noise by the spread of table 5.1:
    # ventilation and wind in a cab
    barometer=BarometerModel(
        rate_hz=1.0,
        offset_std_pa=500.0,
        wander_std_pa=10.0,
        wander_time_s=1800.0,
        noise_pa=35.0,
        buffeting_share=0.1,
        resolution_pa=50.0,
        airflow_coefficient=-0.01,
        fan_step_pa=5.0,
        fan_every_s=300.0,
        temperature_reported=False,
    ),
)
"""The Scania R420 of papers/004."""

CSS = Preset(
    # 129 s until the first fix, 72 m of height wrong then and 11 m after 12 s, 102 of 2374 missing
    gps=GpsModel(
        position_wander_std_m=1.5,
        latency_s=0.35,
        first_fix_s=129.0,
        first_error_m=25.0,
        first_error_time_s=6.4,
        dropped_share=0.043,
    ),
    # at rest from 430 to 452 s only the two steps beside -0.375 occur among 2166 samples, so that
    # white noise is below 0.07 deg/s (a quarter step in 3.5 sigma); 0.05 is a judgement. GNSS
    # follows the gyro 0.1 s sooner than the wheels. From 3 m/s on, faster or slower, its samples
    # change by 0.148 deg/s on the average, at rest by 0.091: the road shakes it.
    gyro=GyroModel(
        rate_hz=100.0,
        bias_degps=-0.37,
        bias_std_degps=0.01,
        bias_wander_std_degps=0.02,
        noise_deg_per_sqrt_s=0.005,
        vibration_degps=0.115,
        resolution_degps=0.25,
        latency_s=0.1,
        jitter_s=0.0008,
        temperature_reported=False,
    ),
    # GNSS is 0.988 times OBD and 0.10 m/s, which over the drive is 0.992 times
    odometer=OdometerModel(
        rate_hz=2.0,
        scale=0.012,
        scale_std=0.0,
        scale_wander_std=0.001,
        resolution_mps=KMH_MPS,
        truncated=True,
        dead_zone_mps=0.0,
        latency_s=0.0,
        jitter_s=0.0006,
        counter_resolution_m=None,
        reverse_reported=False,
    ),
    # more than half of the differences at an even speed are 0, and nothing is below 0
    torque=TorqueModel(
        rate_hz=2.0,
        noise_pct=0.2,
        jitter_s=0.0007,
        mass_error_std=0.05,
        driveline_reported=False,
        overrun_reported=False,
    ),
    barometer=BarometerModel(
        rate_hz=1.0 / 3.0, resolution_pa=1000.0, jitter_s=0.0007, temperature_reported=False
    ),
)
"""The car of css-164; what its README and its standstills show, else the models' defaults."""

PRESETS = {"consumer": CONSUMER, "mems": MEMS, "cheap": CHEAP, "thesis": THESIS, "css": CSS}
