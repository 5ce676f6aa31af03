"""Pure: the messages of a simulated vehicle's CAN bus, as a database and as a drive's mapping."""

from collections.abc import Iterator

from wayline.drive import Condition, SignalMapping
from wayline_simulator.barometer import BarometerModel
from wayline_simulator.gyro import GyroModel
from wayline_simulator.odometer import OdometerModel
from wayline_simulator.presets import Preset
from wayline_simulator.reported_slope import INVALID_PCT
from wayline_simulator.torque import ENGINE_SPEED_STEP_RPM, GEAR_RATIO_STEP, TorqueModel

YAW_ID, WHEELS_ID, TRANSMISSION_ID, ENGINE_ID, SLOPE_ID, AIR_ID = (
    0x1A0,
    0x1B0,
    0x1F0,
    0x200,
    0x220,
    0x3C0,
)
"""The more urgent the smaller, as arbitration asks."""
HEAD = """VERSION ""

NS_ :

BS_:

BU_: VEHICLE
"""


def dbc_text(preset: Preset) -> str:
    """The database of a preset's bus; its factors are the sensors' resolutions."""
    messages = [
        *(_yaw(preset.gyro) if preset.gyro else ()),
        *(_wheels(preset.odometer) if preset.odometer else ()),
        *(_engine(preset.torque) if preset.torque else ()),
        *(_air(preset.barometer) if preset.barometer else ()),
    ]
    comments = {
        f'CM_ SG_ {YAW_ID} YawRate "Positive turning right";': preset.gyro is not None,
        f'CM_ SG_ {TRANSMISSION_ID} Ratio "Of the gearbox; 0 in neutral";': _drives(preset.torque),
        f'CM_ SG_ {SLOPE_ID} Slope "13 while the brake is on: not known";': _slopes(preset.torque),
    }
    said = [comment for comment, needed in comments.items() if needed]
    return "\n".join([HEAD, *messages, *said, ""])


def signals(preset: Preset) -> dict[str, SignalMapping]:
    """`[can.signals]` of drive.toml for a preset's bus, latencies included."""
    return {
        **(_yaw_signals(preset.gyro) if preset.gyro else {}),
        **(_wheel_signals(preset.odometer) if preset.odometer else {}),
        **(_engine_signals(preset.torque) if preset.torque else {}),
        **(_air_signals(preset.barometer) if preset.barometer else {}),
    }


def _message(frame_id: int, name: str, length: int) -> str:
    return f"BO_ {frame_id} {name}: {length} VEHICLE"


def _signal(
    name: str,
    start: int,
    bits: int,
    *,
    factor: float = 1.0,
    offset: float = 0.0,
    signed: bool = False,
    unit: str = "",
) -> str:
    """One little-endian signal with the range that its bits hold."""
    least = -(2 ** (bits - 1)) if signed else 0
    low, high = least * factor + offset, (least + 2**bits - 1) * factor + offset
    sign = "-" if signed else "+"
    return (
        f" SG_ {name} : {start}|{bits}@1{sign} ({factor!r},{offset!r})"
        f' [{low!r}|{high!r}] "{unit}" Vector__XXX'
    )


def _temperature(start: int) -> str:
    return _signal("Temperature", start, 8, offset=-40.0, unit="degC")


def _yaw(model: GyroModel) -> Iterator[str]:
    yield _message(YAW_ID, "Yaw", 3)
    yield _signal("YawRate", 0, 16, factor=model.resolution_degps, signed=True, unit="deg/s")
    if model.temperature_reported:
        yield _temperature(16)
    yield ""


def _yaw_signals(model: GyroModel) -> dict[str, SignalMapping]:
    quantities = {"gyro.yaw_rate_degps": "YawRate"}
    if model.temperature_reported:
        quantities["gyro.temperature_c"] = "Temperature"
    return _mapped("Yaw", quantities, model.latency_s)


def _wheels(model: OdometerModel) -> Iterator[str]:
    yield _message(WHEELS_ID, "Wheels", 7)
    yield _signal("Speed", 0, 16, factor=model.resolution_mps, unit="m/s")
    if model.reverse_reported:
        yield _signal("Reverse", 16, 1)
    if model.counter_resolution_m is not None:
        factor = model.counter_resolution_m
        yield _signal("Distance", 24, model.counter_bits, factor=factor, unit="m")
    yield ""


def _wheel_signals(model: OdometerModel) -> dict[str, SignalMapping]:
    quantities = {"odometer.speed_mps": "Speed"}
    if model.counter_resolution_m is not None:
        quantities["odometer.distance_m"] = "Distance"
    if model.reverse_reported:
        quantities["odometer.reverse"] = "Reverse"
    return _mapped("Wheels", quantities, model.latency_s)


def _drives(model: TorqueModel | None) -> bool:
    return model is not None and model.driveline_reported


def _slopes(model: TorqueModel | None) -> bool:
    return model is not None and model.slope_reported


def _engine(model: TorqueModel) -> Iterator[str]:
    if model.driveline_reported:
        yield _message(TRANSMISSION_ID, "Transmission", 3)
        yield _signal("Gear", 0, 8, signed=True)
        yield _signal("Ratio", 8, 16, factor=GEAR_RATIO_STEP)
        yield ""
    yield _message(ENGINE_ID, "Engine", 5)
    yield _signal("Torque", 0, 16, factor=model.resolution_pct, signed=True, unit="%")
    yield _signal("EngineSpeed", 16, 16, factor=ENGINE_SPEED_STEP_RPM, unit="rpm")
    if model.driveline_reported:
        yield _signal("Brake", 32, 1)
        yield _signal("Clutch", 33, 1)
    yield ""
    if model.slope_reported:
        yield _message(SLOPE_ID, "Slope", 2)
        yield _signal("Slope", 0, 16, factor=model.slope_resolution_pct, signed=True, unit="%")
        yield ""


def _engine_signals(model: TorqueModel) -> dict[str, SignalMapping]:
    engine = {"torque.engine_torque_pct": "Torque", "torque.engine_speed_rpm": "EngineSpeed"}
    mapped: dict[str, SignalMapping] = {}
    if model.driveline_reported:
        engine |= {"torque.brake": "Brake", "torque.clutch": "Clutch"}
        mapped |= _mapped("Transmission", {"torque.gear": "Gear"}, model.latency_s)
        mapped["torque.gear_ratio"] = SignalMapping(
            message="Transmission",
            signal="Ratio",
            valid=Condition(signal="Ratio", min=GEAR_RATIO_STEP),
            latency_s=model.latency_s,
        )
    mapped |= _mapped("Engine", engine, model.latency_s)
    if model.slope_reported:
        valid = INVALID_PCT - model.slope_resolution_pct / 2.0
        mapped["torque.slope_pct"] = SignalMapping(
            message="Slope",
            signal="Slope",
            valid=Condition(signal="Slope", max=valid),
            latency_s=model.latency_s + model.slope_filter_s,
        )
    return mapped


def _air(model: BarometerModel) -> Iterator[str]:
    yield _message(AIR_ID, "Air", 4)
    yield _signal("Pressure", 0, 24, factor=model.resolution_pa, unit="Pa")
    if model.temperature_reported:
        yield _temperature(24)
    yield ""


def _air_signals(model: BarometerModel) -> dict[str, SignalMapping]:
    quantities = {"barometer.pressure_pa": "Pressure"}
    if model.temperature_reported:
        quantities["barometer.temperature_c"] = "Temperature"
    return _mapped("Air", quantities, 0.0)


def _mapped(message: str, quantities: dict[str, str], latency_s: float) -> dict[str, SignalMapping]:
    return {
        quantity: SignalMapping(message=message, signal=signal, latency_s=latency_s)
        for quantity, signal in quantities.items()
    }
