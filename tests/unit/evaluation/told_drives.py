"""Small simulated drives, ingested: what a yardstick is told and what it is judged by."""

from collections.abc import Iterator

import numpy as np

from unit.simulator.journeys import WHEEL_RADIUS_M, turns_and_stops
from wayline.drive import Vehicle
from wayline.messages import Barometer, GpsFix, Gyro, Message, Odometer
from wayline_evaluation.estimates import Floats
from wayline_evaluation.reference import Reference, true_reference
from wayline_evaluation.sensed import Sensed, sensed_of
from wayline_simulator import barometer, gyro, odometer
from wayline_simulator.barometer import BarometerModel
from wayline_simulator.facts import Facts
from wayline_simulator.gps import measure_fixes
from wayline_simulator.gps_events import GpsEvents, Outage
from wayline_simulator.gps_model import GpsModel
from wayline_simulator.gyro import GyroModel
from wayline_simulator.journey import Journey
from wayline_simulator.odometer import OdometerModel
from wayline_simulator.weather import Weather

START_S = 1_767_250_800.0
FACTS = Facts(
    preset="test",
    seed=1,
    run=1,
    gps=GpsModel(systems=("gps",)),
    gyro=GyroModel(),
    odometer=OdometerModel(),
    torque=None,
    barometer=BarometerModel(),
    weather=Weather(),
    mass_kg=1500.0,
)


def blocks(count: int = 8) -> Journey:
    """Round the houses with stops; 40 s a block."""
    return turns_and_stops(count)


def poses_s(journey: Journey) -> Floats:
    """Instants ten times a second, from 30 s on."""
    return START_S + np.arange(300, int(journey.duration_s * 10.0)) / 10.0


def truth(journey: Journey) -> Reference:
    """What happened, ten times a second."""
    known = journey.at(np.arange(int(journey.duration_s * 10.0) + 1) / 10.0)
    return true_reference(
        START_S + known.times_s,
        known.lats_deg,
        known.lons_deg,
        alts_m=known.alts_m,
        headings_deg=known.headings_deg,
        speeds_mps=known.speeds_mps,
        grades_pct=known.grades_pct,
    )


def sensed(journey: Journey, seed: int, *outages: Outage, facts: Facts = FACTS) -> Sensed:
    """One drive with errors of its own, every latency taken off."""
    return sensed_of(_messages(journey, facts, outages, np.random.default_rng(seed)))


def _messages(
    journey: Journey, facts: Facts, outages: tuple[Outage, ...], random: np.random.Generator
) -> Iterator[Message]:
    assert facts.gps is not None
    assert facts.gyro is not None
    assert facts.odometer is not None
    turned = gyro.measure(journey, facts.gyro, facts.weather, device=random, random=random)
    for time_s, rate in zip(turned.instants_s, turned.yaw_rates_degps, strict=True):
        yield Gyro(t_ns=_ns(time_s), yaw_rate_degps=float(rate))
    vehicle = Vehicle(wheel_radius_m=WHEEL_RADIUS_M)
    rolled = odometer.measure(journey, facts.odometer, vehicle, device=random, random=random)
    for time_s, speed_mps in zip(rolled.instants_s, rolled.speeds_mps, strict=True):
        yield Odometer(t_ns=_ns(time_s), speed_mps=float(speed_mps))
    if facts.barometer is not None:
        pressed = barometer.measure(
            journey, facts.barometer, facts.weather, device=random, random=random
        )
        for time_s, pressure_pa in zip(pressed.instants_s, pressed.pressures_pa, strict=True):
            yield Barometer(t_ns=_ns(time_s), pressure_pa=float(pressure_pa))
    fixes = measure_fixes(journey, facts.gps, GpsEvents(outages=outages), START_S, random)
    for row, valid in enumerate(fixes.valid):
        t_ns = _ns(float(fixes.described_s[row]))
        if not valid:
            yield GpsFix(t_ns=t_ns, valid=False)
            continue
        course_deg = float(fixes.courses_deg[row])
        yield GpsFix(
            t_ns=t_ns,
            valid=True,
            lat_deg=float(fixes.lats_deg[row]),
            lon_deg=float(fixes.lons_deg[row]),
            alt_m=round(float(fixes.alts_m[row]), 1),
            speed_mps=float(fixes.speeds_mps[row]),
            course_deg=None if np.isnan(course_deg) else course_deg,
            mode=3,
            hdop=float(fixes.hdop[row]),
            vdop=float(fixes.vdop[row]),
        )


def _ns(time_s: float) -> int:
    return round((START_S + float(time_s)) * 1e9)
