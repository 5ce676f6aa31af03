"""Recorded GTFS-Realtime vehicle positions of an agency, as the reports of one of its vehicles."""

import io
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path

from wayline.drive import AvlSource, Vehicle
from wayline.errors import InputError
from wayline.inputs import PositionReport
from wayline.log_file import LogFile
from wayline.received import Account, Recording, translated
from wayline.vehicle_ids import vehicle_id_of
from wayline_gps_ingest.agency import Agency
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.vehicle_positions import (
    NotRealtimeError,
    Snapshot,
    VehicleReport,
    read_vehicle_positions,
)

NAMED_MAX = 5
"""Vehicles that an error names."""
NUMBER = re.compile(r"(\d+)")


def agency_recording(source: AvlSource, vehicle_id: str, vehicle: Vehicle, name: str) -> Recording:
    """The reports of a drive's vehicle: the one that `where` tells, or that is called so.

    Where a recording holds one vehicle only, it is that, whatever its name.
    """
    core = GpsIngestCore(vehicle.gps_latency_s, recorded=True)
    latency_ns = round(vehicle.gps_latency_s * 1e9)
    reports = AgencyLog(source, vehicle_id)
    messages = translated(reports, core.handle, name, lambda _, fix: fix.t_ns + latency_ns)
    return Recording(
        name,
        messages,
        lambda: core.bad_input + reports.bad_input,
        lambda: Account(reports.left_out),
        partial(_nothing, source, vehicle_id, reports),
    )


class AgencyLog:
    """Recorded answers of a feed, in one file or a folder of them, read once."""

    def __init__(self, source: AvlSource, vehicle_id: str) -> None:
        self._files = files_of(Path(source.path))
        self._where = {name: str(value) for name, value in source.where.items()}
        self._vehicle_id = vehicle_id
        self._agency = Agency()
        self.unreadable: Counter[str] = Counter()
        """Files, or lines of one, that are no feed, by what they are."""
        self.others: Counter[str] = Counter()
        """Reports of other vehicles, by their agency's names."""

    @property
    def bad_input(self) -> int:
        """What was counted and dropped."""
        return self.unreadable.total() + sum(self._agency.faults.values())

    @property
    def left_out(self) -> Mapping[str, int]:
        """Reports left out on purpose, by reason."""
        return {"of other vehicles": self.others.total()} if self.others else {}

    def __iter__(self) -> Iterator[PositionReport]:
        is_only = not self._where and _is_of_one(self._files)
        for snapshot in self._snapshots():
            asked = [told for told in snapshot.vehicles if is_only or self._is_asked(told)]
            for _, report in self._agency.take(snapshot._replace(vehicles=tuple(asked))):
                yield report

    def _snapshots(self) -> Iterator[Snapshot]:
        for path in self._files:
            for read in snapshots_of(path):
                if isinstance(read, Snapshot):
                    yield read
                else:
                    self.unreadable[str(read)] += 1

    def _is_asked(self, told: VehicleReport) -> bool:
        if self._where:
            is_asked = all(told.names.get(name) == value for name, value in self._where.items())
        else:
            is_asked = vehicle_id_of(told.vehicle) == self._vehicle_id
        if not is_asked:
            self.others[told.vehicle] += 1
        return is_asked


def files_of(path: Path) -> list[Path]:
    """A file, or a folder's by name, numbers in them by value. Raises InputError of none."""
    if not path.is_dir():
        return [path]

    def by_number(file: Path) -> list[tuple[int, str]]:
        return [(int(part) if part.isdigit() else -1, part) for part in NUMBER.split(file.name)]

    found = sorted((file for file in path.iterdir() if file.is_file()), key=by_number)
    if not found:
        raise InputError(str(path), "is an empty folder", "name one with the feed's answers")
    return found


def snapshots_of(path: Path) -> Iterator[Snapshot | NotRealtimeError]:
    """What a file holds: one answer, or one in JSON a line, packed or not. Raises InputError."""
    try:
        with LogFile(path) as log, io.BufferedReader(log) as file:
            payload = file.read()
    except OSError as error:
        what = f"cannot be read ({error.strerror or error})"
        raise InputError(str(path), what, "check the file") from None
    try:
        yield read_vehicle_positions(payload)
    except NotRealtimeError as error:
        lines = payload.splitlines() if payload.startswith(b"{") else []
        if len(lines) < 2:
            yield error
        else:
            yield from map(_of_line, lines)


def _of_line(line: bytes) -> Snapshot | NotRealtimeError:
    try:
        return read_vehicle_positions(line)
    except NotRealtimeError as error:
        return error


def _is_of_one(files: list[Path]) -> bool:
    names: set[str] = set()
    for path in files:
        for read in snapshots_of(path):
            names |= (
                {told.vehicle for told in read.vehicles} if isinstance(read, Snapshot) else set()
            )
            if len(names) > 1:
                return False
    return True


def _nothing(source: AvlSource, vehicle_id: str, log: AgencyLog) -> InputError:
    if log.others:
        asked = ", ".join(f"{name} {value}" for name, value in source.where.items()) or vehicle_id
        named = ", ".join(sorted(log.others)[:NAMED_MAX])
        what = f"none of its {len(log.others):,} vehicles is {asked} (there are {named}, ...)"
        return InputError(source.path, what, 'name one: where = { vehicle_id = "..." }')
    if log.unreadable:
        what = f"holds no GTFS-Realtime, but {log.unreadable.most_common(1)[0][0]}"
        mend = "give vehicle positions as protobuf or JSON, or columns for a CSV"
        return InputError(source.path, what, mend)
    return InputError(source.path, "tells of no vehicle where it is", "give vehicle positions")
