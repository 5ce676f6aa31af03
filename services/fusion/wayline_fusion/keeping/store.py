"""Keeps one vehicle's calibration and last pose in the fusion database."""

import json
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite

from wayline.core import Record
from wayline.database import write_transaction
from wayline_fusion.keeping.records import LastHeight, LastPose, Saved, SensorCalibration
from wayline_fusion.keeping.tables import VEHICLES


class FusionStore:
    """One vehicle's row, on an engine from `open_database(url, "wayline_fusion")`.

    The row that was written last stands, also when it is of an earlier time: a clock that once
    ran ahead must not keep what is learned later from being kept.
    """

    def __init__(self, engine: sa.Engine, vehicle_id: str) -> None:
        self._engine, self._vehicle_id = engine, vehicle_id

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        """Keep what is known of the vehicle in place of what was; there is no answer."""
        if not isinstance(record, Saved):
            raise TypeError(f"fusion keeps no {type(record).__name__}")
        row = {"vehicle_id": self._vehicle_id, **_row(record)}
        with write_transaction(self._engine) as connection:
            connection.execute(_replacing(connection), row)
        return ()

    def load(self) -> Saved | None:
        """What was kept of this vehicle."""
        query = sa.select(VEHICLES).where(VEHICLES.c.vehicle_id == self._vehicle_id)
        with self._engine.connect() as connection:
            row = connection.execute(query).mappings().first()
        # SQLAlchemy's names are strings of a kind that msgspec does not take
        return None if row is None else _saved({str(name): value for name, value in row.items()})


class Found(NamedTuple):
    """What there was of a vehicle in a database that could be asked."""

    saved: Saved | None


class FusionTables:
    """Every vehicle's row, for a `PatientStore`.

    `told` are the vehicles whose cores know what was kept of them. Another one's began without it,
    because the database was away: what is kept stays until what was learned anew is as sure.
    """

    def __init__(self, engine: sa.Engine, told: set[str]) -> None:
        self._engine, self._told = engine, told

    def load(self, vehicle_id: str) -> Found:
        """What was kept of a vehicle, for its core."""
        return Found(FusionStore(self._engine, vehicle_id).load())

    def save(self, vehicle_id: str, record: Record) -> Sequence[msgspec.Struct]:
        """Keep what is known of a vehicle; there is no answer."""
        store = FusionStore(self._engine, vehicle_id)
        if vehicle_id not in self._told and isinstance(record, Saved):
            record = _with_surer_calibration(record, store.load())
        return store.save(record)

    def look(self) -> Sequence[msgspec.Struct]:
        """Nothing: no other process writes of these vehicles."""
        return ()


def _with_surer_calibration(learned: Saved, kept: Saved | None) -> Saved:
    if kept is None:
        return learned
    new, old = learned.calibration, kept.calibration
    is_as_sure = (
        new.gyro_bias_std_degps <= old.gyro_bias_std_degps
        and new.gyro_scale_std <= old.gyro_scale_std
        and new.odometer_scale_std <= old.odometer_scale_std
    )
    return learned if is_as_sure else msgspec.structs.replace(learned, calibration=old)


def _row(saved: Saved) -> dict[str, object]:
    calibration = msgspec.structs.asdict(saved.calibration)
    pose = dict.fromkeys(LastPose.__struct_fields__)
    if saved.pose is not None:
        pose = msgspec.structs.asdict(saved.pose)
    height = dict.fromkeys(LastHeight.__struct_fields__)
    if saved.height is not None:
        height = msgspec.structs.asdict(saved.height)
    correlations = json.dumps(saved.calibration.correlations)
    return {"t_ns": saved.t_ns, **calibration, **pose, **height, "correlations": correlations}


def _saved(row: dict[str, object]) -> Saved:
    row["correlations"] = json.loads(str(row["correlations"]))
    is_placed = row["lat_deg"] is not None
    return Saved(
        t_ns=msgspec.convert(row["t_ns"], int),
        calibration=msgspec.convert(row, SensorCalibration),
        pose=msgspec.convert(row, LastPose) if is_placed else None,
        height=msgspec.convert(row, LastHeight) if row["alt_m"] is not None else None,
    )


def _replacing(connection: sa.Connection) -> sa.Insert:
    is_sqlite = connection.dialect.name == "sqlite"
    insert = sqlite.insert(VEHICLES) if is_sqlite else postgresql.insert(VEHICLES)
    key = VEHICLES.c.vehicle_id.name
    columns = {column.name: insert.excluded[column.name] for column in VEHICLES.c}
    del columns[key]
    return insert.on_conflict_do_update(index_elements=[key], set_=columns)
