"""Pure: packs a vehicle's samples into frames, laid out as its DBC says."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from cantools.database.can import Database, Message
from numpy.typing import NDArray

from wayline_simulator.journey import Floats
from wayline_simulator.stream import Frames
from wayline_simulator.vehicle_sensors import VehicleSamples

FRAME_S = 0.00025
"""What a frame of 8 bytes takes at 500 kbit/s; messages of one unit follow each other so."""


class Columns(NamedTuple):
    """The values of a message's signals, frame by frame."""

    message: str
    times_s: Floats
    values: Mapping[str, NDArray[Any]]
    """Physical values by signal; those that the database has not are left out."""


def bus_frames(samples: VehicleSamples, dbc: str) -> list[Frames]:
    """All frames of a drive, one entry a CAN id; `dbc` is the text of the bus's database."""
    database = Database()
    database.add_dbc_string(dbc)
    packed = []
    for columns in _columns(samples):
        message = _found(database, columns.message)
        if message is not None:
            packed.append(Frames(message.frame_id, columns.times_s, pack(message, columns.values)))
    return packed


def pack(message: Message, values: Mapping[str, NDArray[Any]]) -> NDArray[np.uint8]:
    """Frames of little-endian signals, shape (n, bytes); what exceeds its bits saturates."""
    count = len(next(iter(values.values())))
    words = np.zeros(count, dtype=np.uint64)
    for signal in message.signals:
        scale, offset = signal.conversion.scale, signal.conversion.offset
        least = -(2 ** (signal.length - 1)) if signal.is_signed else 0
        most = least + 2**signal.length - 1
        raw = np.rint((values[signal.name].astype(np.float64) - offset) / scale)
        bits = np.clip(raw, least, most).astype(np.int64) & (2**signal.length - 1)
        words |= bits.astype(np.uint64) << np.uint64(signal.start)
    octets: NDArray[np.uint8] = words.astype("<u8").view(np.uint8).reshape(count, 8)
    return octets[:, : message.length]


def _columns(samples: VehicleSamples) -> Iterator[Columns]:
    if gyro := samples.gyro:
        rates = {"YawRate": gyro.yaw_rates_degps, "Temperature": gyro.temperatures_c}
        yield Columns("Yaw", gyro.times_s, rates)
    if wheels := samples.odometer:
        rolling: dict[str, NDArray[Any]] = {
            "Speed": wheels.speeds_mps,
            "Reverse": wheels.reverse,
            "Distance": wheels.distances_m,
        }
        yield Columns("Wheels", wheels.times_s, rolling)
    yield from _engine_columns(samples)
    if air := samples.barometer:
        state = {"Pressure": air.pressures_pa, "Temperature": air.temperatures_c}
        yield Columns("Air", air.times_s, state)


def _engine_columns(samples: VehicleSamples) -> Iterator[Columns]:
    torque = samples.torque
    if torque is None:
        return
    geared: dict[str, NDArray[Any]] = {"Gear": torque.gears, "Ratio": torque.gear_ratios}
    yield Columns("Transmission", torque.times_s, geared)
    engine: dict[str, NDArray[Any]] = {
        "Torque": torque.torques_pct,
        "EngineSpeed": torque.engine_speeds_rpm,
        "Brake": torque.brake,
        "Clutch": torque.clutch,
    }
    yield Columns("Engine", torque.times_s + FRAME_S, engine)
    if samples.slopes_pct is not None:
        yield Columns("Slope", torque.times_s + 2 * FRAME_S, {"Slope": samples.slopes_pct})


def _found(database: Database, name: str) -> Message | None:
    return next((message for message in database.messages if message.name == name), None)
