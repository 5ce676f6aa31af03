"""`wayline evaluate sensors`: what sensors did, simulated beside recorded."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from wayline.drive import Drive, DriveInfo, NmeaSource
from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline.messages import GpsFix
from wayline_evaluation.replays import Progressed, drive_name
from wayline_evaluation.sensed import Sensed, sensed_of
from wayline_evaluation.sensor_gps import GpsFigures, gps_figures
from wayline_evaluation.sensor_record import Epochs, SensorRecord, epochs_of
from wayline_evaluation.sensor_vehicle import (
    BarometerFigures,
    GyroFigures,
    OdometerFigures,
    barometer_figures,
    gyro_figures,
    odometer_figures,
)
from wayline_evaluation.standstills import Span, standstills
from wayline_evaluation.truth import read_truth
from wayline_replay.stream import DriveStream
from wayline_simulator.facts import Facts
from wayline_simulator.facts_file import read_facts

NMEA_SUFFIXES = (".nmea", ".log", ".txt")
DOPPLER_REST_MPS = 0.5
"""Well above what receivers report at rest, so that their noise is not cut off."""


class SensorColumn(msgspec.Struct, frozen=True, kw_only=True):
    """The sensors of one drive, or of several pooled; null where there is no such sensor."""

    drives: tuple[str, ...]
    gps: GpsFigures | None
    gyro: GyroFigures | None
    odometer: OdometerFigures | None
    barometer: BarometerFigures | None


class SensorReport(msgspec.Struct, frozen=True, kw_only=True):
    """What the drives' sensors are like: all drives pooled, then each drive."""

    columns: tuple[SensorColumn, ...]


@dataclass(frozen=True, slots=True)
class Group:
    """What one column is made of."""

    title: str
    records: tuple[SensorRecord, ...]


def sensor_study(
    drives: Sequence[Path], beside: Sequence[Path], progressed: Progressed
) -> tuple[SensorReport, list[Group]]:
    """Figures, and the records that a plot is made of. Raises InputError."""
    records = []
    for number, path in enumerate((*drives, *beside)):
        progressed(number, len(drives) + len(beside))
        records.append(read_sensors(path))
    pooled, others = tuple(records[: len(drives)]), records[len(drives) :]
    groups = [Group(_title(pooled), pooled), *(Group(each.drive, (each,)) for each in others)]
    return SensorReport(columns=tuple(_column(group) for group in groups)), groups


def _title(records: Sequence[SensorRecord]) -> str:
    return records[0].drive if len(records) == 1 else f"{len(records)} drives"


def _column(group: Group) -> SensorColumn:
    return SensorColumn(
        drives=tuple(record.drive for record in group.records),
        gps=gps_figures(group.records),
        gyro=gyro_figures(group.records),
        odometer=odometer_figures(group.records),
        barometer=barometer_figures(group.records),
    )


def read_sensors(path: Path) -> SensorRecord:
    """Of a drive's folder, or of a receiver's log with dates alone. Raises InputError."""
    if path.suffix in NMEA_SUFFIXES and path.is_file():
        recording = NmeaSource(path=str(path))
        drive = Drive(drive=DriveInfo(vehicle_id="receiver"), nmea=(recording,))
        return _record(drive, path, path.stem, None)
    drive = load_drive(path)
    folder = path.parent if path.suffix == ".toml" else path
    return _record(drive, path, drive_name(path), read_facts(folder))


def _record(drive: Drive, where: Path, name: str, facts: Facts | None) -> SensorRecord:
    messages = [arrival.message for arrival in DriveStream(drive, str(where))]
    sensed = sensed_of(messages)
    fixes = sorted(
        (message for message in messages if isinstance(message, GpsFix)), key=lambda fix: fix.t_ns
    )
    if not messages:
        raise InputError(str(where), "has no message", "check its recordings and mappings")
    truth = None if drive.truth is None else read_truth(Path(drive.truth.path))
    epochs = epochs_of(fixes, truth)
    return SensorRecord(
        drive=name,
        start_s=sensed.start_s,
        epochs=epochs,
        gyro=sensed.yaw_rate_degps,
        odometer=sensed.speed_mps,
        barometer=sensed.pressure_pa,
        rests=_rests(sensed, epochs),
        has_truth=truth is not None,
        facts=facts,
    )


def _rests(sensed: Sensed, epochs: Epochs) -> tuple[Span, ...]:
    """By the wheels; by Doppler where there are none."""
    if len(sensed.speed_mps):
        return standstills(sensed.speed_mps.times_s, sensed.speed_mps.values == 0.0)
    return standstills(epochs.times_s, epochs.speeds_mps < DOPPLER_REST_MPS)
