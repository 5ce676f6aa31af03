"""Pure: vehicles: what moves them and what holds them back."""

from typing import Annotated

from msgspec import Meta

from wayline.drive import Vehicle
from wayline.strict import Strict
from wayline_simulator.drive_train import EngineModel, GearboxModel
from wayline_simulator.tyres import TyreModel

Positive = Annotated[float, Meta(gt=0.0)]
Share = Annotated[float, Meta(gt=0.0, le=1.0)]


class VehicleModel(Strict, frozen=True, kw_only=True):
    """A vehicle as it truly is; values without a source are judgement for one of its kind."""

    mass_kg: Positive
    """With load."""
    wheel_radius_m: Positive
    """Nominal; also the lever arm of the drive force."""
    wheel_inertia_kgm2: Positive
    """Of all wheels together."""
    frontal_area_m2: Positive
    drag_coefficient: Positive
    rolling_coefficient: Positive
    driven_share: Share
    """Of the weight, on the driven wheels."""
    top_speed_mps: Positive
    """By law or limiter."""
    comfort_share: Share
    """Of the driver's accelerations, that load or passengers allow."""
    engine: EngineModel
    gearbox: GearboxModel
    tyres: TyreModel

    def __post_init__(self) -> None:
        """Refuse tables that do not fit each other; msgspec makes a ValidationError of it."""
        if len(self.engine.speeds_rpm) != len(self.engine.torques_nm):
            raise ValueError("engine: speeds_rpm and torques_nm differ in length")
        if self.gearbox.launch_gear > len(self.gearbox.ratios):
            raise ValueError("gearbox: launch_gear is not among the ratios")


CAR = VehicleModel(
    mass_kg=1500.0,
    wheel_radius_m=0.31,
    wheel_inertia_kgm2=3.6,
    frontal_area_m2=2.2,
    drag_coefficient=0.30,
    rolling_coefficient=0.010,
    driven_share=0.6,
    top_speed_mps=50.0,
    comfort_share=1.0,
    engine=EngineModel(
        # 1.5 l turbo petrol: 250 Nm from 1500 to 3500 rpm, 110 kW at 5000 to 6000, as Volkswagen
        # gives for its EA211 evo; below 1500 judgement
        speeds_rpm=(700.0, 1000.0, 1500.0, 3500.0, 5000.0, 6000.0),
        torques_nm=(90.0, 150.0, 250.0, 250.0, 210.0, 175.0),
        idle_rpm=800.0,
        launch_rpm=1150.0,
        drag_nm=10.0,
        drag_nm_per_rpm=0.005,
        inertia_kgm2=0.18,
    ),
    gearbox=GearboxModel(
        ratios=(3.77, 1.96, 1.28, 0.97, 0.78, 0.65),
        reverse_ratio=3.6,
        final_drive_ratio=4.06,
        efficiency=0.92,
        launch_gear=1,
        shift_s=0.4,
        ramp_s=0.2,
        up_light_rpm=1900.0,
        up_full_rpm=4500.0,
        down_light_rpm=1000.0,
        down_full_rpm=1700.0,
        skip=0,
        pause_s=1.5,
    ),
    tyres=TyreModel(nominal_mass_kg=1500.0),
)
"""A compact car with a six-speed gearbox; mass, wheels and air as the defaults of `[vehicle]`."""

TRUCK = VehicleModel(
    mass_kg=40_000.0,
    wheel_radius_m=0.5,
    wheel_inertia_kgm2=180.0,
    frontal_area_m2=9.7,
    drag_coefficient=0.60,
    rolling_coefficient=0.006,
    driven_share=0.29,
    top_speed_mps=89.0 / 3.6,
    comfort_share=0.55,
    engine=EngineModel(
        # 11.7 l Diesel of 420 hp like papers/004's Scania R420: 2100 Nm from 1100 to 1350 rpm and
        # 309 kW at 1900 as Scania gives for its DC12; the rest judgement
        speeds_rpm=(500.0, 700.0, 900.0, 1100.0, 1350.0, 1600.0, 1900.0, 2100.0),
        torques_nm=(1000.0, 1300.0, 1750.0, 2100.0, 2100.0, 1840.0, 1553.0, 1100.0),
        idle_rpm=500.0,
        launch_rpm=700.0,
        drag_nm=60.0,
        drag_nm_per_rpm=0.08,
        exhaust_brake_nm=600.0,
        inertia_kgm2=3.5,
    ),
    gearbox=GearboxModel(
        # the steps of Scania's twelve-speed range-splitter gearboxes, a factor of 1.25 each
        ratios=(11.32, 9.16, 7.19, 5.82, 4.63, 3.75, 3.02, 2.44, 1.92, 1.55, 1.24, 1.00),
        reverse_ratio=9.16,
        final_drive_ratio=2.92,
        efficiency=0.93,
        launch_gear=3,
        shift_s=0.8,
        ramp_s=0.3,
        up_light_rpm=1250.0,
        up_full_rpm=1700.0,
        down_light_rpm=850.0,
        down_full_rpm=1080.0,
        skip=2,
        pause_s=2.0,
    ),
    tyres=TyreModel(nominal_mass_kg=40_000.0, warming_s=1800.0),
)
"""A laden articulated truck; 40 t is the limit of Council Directive 96/53/EC, and its speed limiter
is set below the 90 km/h of Directive 92/6/EEC as amended."""

BUS = VehicleModel(
    mass_kg=14_000.0,
    wheel_radius_m=0.465,
    wheel_inertia_kgm2=60.0,
    frontal_area_m2=7.2,
    drag_coefficient=0.60,
    rolling_coefficient=0.008,
    driven_share=0.65,
    top_speed_mps=85.0 / 3.6,
    comfort_share=0.65,
    engine=EngineModel(
        # 7.7 l Diesel: 1200 Nm from 1200 to 1600 rpm and 220 kW at 2200, as Mercedes-Benz gives for
        # its OM 936; the rest judgement
        speeds_rpm=(600.0, 800.0, 1000.0, 1200.0, 1600.0, 2200.0, 2500.0),
        torques_nm=(600.0, 800.0, 1050.0, 1200.0, 1200.0, 955.0, 600.0),
        idle_rpm=600.0,
        launch_rpm=850.0,
        drag_nm=40.0,
        drag_nm_per_rpm=0.05,
        exhaust_brake_nm=250.0,
        inertia_kgm2=1.6,
    ),
    gearbox=GearboxModel(
        # ZF EcoLife 6 AP; its converter is taken for a slipping clutch
        ratios=(3.364, 1.909, 1.421, 1.0, 0.720, 0.615),
        reverse_ratio=4.235,
        final_drive_ratio=5.77,
        efficiency=0.92,
        launch_gear=1,
        shift_s=0.3,
        ramp_s=0.2,
        up_light_rpm=1350.0,
        up_full_rpm=2050.0,
        down_light_rpm=900.0,
        down_full_rpm=1300.0,
        skip=0,
        pause_s=1.8,
    ),
    tyres=TyreModel(nominal_mass_kg=14_000.0, warming_s=1500.0),
)
"""A twelve-metre city bus, half full."""

VEHICLES = {"car": CAR, "truck": TRUCK, "bus": BUS}


def vehicle_table(vehicle: VehicleModel, mass_kg: float) -> Vehicle:
    """`[vehicle]` for drive.toml, with the mass that the vehicle is believed to have."""
    return Vehicle(
        mass_kg=mass_kg,
        wheel_radius_m=vehicle.wheel_radius_m,
        frontal_area_m2=vehicle.frontal_area_m2,
        drag_coefficient=vehicle.drag_coefficient,
        rolling_coefficient=vehicle.rolling_coefficient,
        driveline_efficiency=vehicle.gearbox.efficiency,
        final_drive_ratio=vehicle.gearbox.final_drive_ratio,
        gear_ratios=vehicle.gearbox.ratios,
        engine_reference_torque_nm=max(vehicle.engine.torques_nm),
    )


def rigid_mass_kg(vehicle: VehicleModel) -> float:
    """The vehicle's mass and that of its wheels' rotation."""
    return vehicle.mass_kg + vehicle.wheel_inertia_kgm2 / vehicle.wheel_radius_m**2


def engine_mass_kg(vehicle: VehicleModel, gear_ratio: float) -> float:
    """What the engine's rotation adds while the clutch is closed.

    An engine's torque is stated at constant speed, so its inertia counts on the vehicle's side.
    """
    wheel_turns = gear_ratio * vehicle.gearbox.final_drive_ratio / vehicle.wheel_radius_m
    return vehicle.engine.inertia_kgm2 * wheel_turns**2
