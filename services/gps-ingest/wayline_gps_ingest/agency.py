"""Pure: a whole agency's vehicles, from one look at its feed to the next."""

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from wayline.inputs import PositionReport
from wayline.vehicle_ids import vehicle_id_of
from wayline_gps_ingest.reports import has_place
from wayline_gps_ingest.vehicle_positions import SECOND_NS, Snapshot, VehicleReport

AHEAD_NS = 60 * SECOND_NS
"""Clocks differ; a report that is later than its feed by more is of no time."""
COPY_NS = 600 * SECOND_NS
"""Servers that share the work keep copies of a feed, some older than others by no more."""


class Known(NamedTuple):
    """Of a vehicle."""

    name: str
    """As the agency has it."""
    told_ns: int
    """When it was last where it said."""


class Agency:
    """What each of an agency's vehicles has said, so that nothing is passed on twice.

    A feed repeats a vehicle's report until there is a new one, and servers answer with older
    copies; that is no fault. Faults are counted by reason: `no id` (nothing of the name can be
    one), `two with one id` (the first name keeps it), `earlier` (than the vehicle's last one),
    `ahead` (of the feed's own time, or of its receipt), `no place` (nor time).
    """

    def __init__(self) -> None:
        self._known: dict[str, Known] = {}
        self._told_ns = 0
        self._faults: Counter[str] = Counter()

    @property
    def faults(self) -> Mapping[str, int]:
        """What was counted and dropped, by reason."""
        return self._faults

    @property
    def told_ns(self) -> int:
        """When the newest feed was put together; 0 before the first."""
        return self._told_ns

    def take(
        self, snapshot: Snapshot, received_ns: int | None = None
    ) -> Iterator[tuple[str, PositionReport]]:
        """The reports that are new, each with its vehicle's id; a recording has no receipt."""
        told_ns = snapshot.told_ns or received_ns
        if told_ns is not None:
            if received_ns is not None and told_ns > received_ns + AHEAD_NS:
                self._faults["ahead"] += 1
                return
            if 0 <= self._told_ns - told_ns < COPY_NS:
                return
            self._told_ns = told_ns
        placed = [told for told in snapshot.vehicles if has_place(told.report)]
        if unplaced := snapshot.unplaced + len(snapshot.vehicles) - len(placed):
            self._faults["no place"] += unplaced
        for told in placed:
            vehicle_id = self._id(told)
            if vehicle_id is not None and self._is_new(vehicle_id, told, told_ns):
                yield vehicle_id, told.report

    def _id(self, told: VehicleReport) -> str | None:
        vehicle_id = vehicle_id_of(told.vehicle)
        if vehicle_id is None:
            self._faults["no id"] += 1
            return None
        known = self._known.get(vehicle_id)
        if known is not None and known.name != told.vehicle:
            self._faults["two with one id"] += 1
            return None
        return vehicle_id

    def _is_new(self, vehicle_id: str, told: VehicleReport, feed_ns: int | None) -> bool:
        known, t_ns = self._known.get(vehicle_id), told.report.t_ns
        if feed_ns is not None and t_ns > feed_ns + AHEAD_NS:
            self._faults["ahead"] += 1
            return False
        if known is not None and t_ns <= known.told_ns:
            if t_ns < known.told_ns:
                self._faults["earlier"] += 1
            return False
        self._known[vehicle_id] = Known(told.vehicle, t_ns)
        return True
