"""Pure: the views of all vehicles, and what a reader has not seen of them yet."""

from dataclasses import dataclass, field

import msgspec

from wayline.keys import FLEET
from wayline.messages import Pose
from wayline.rfc3339 import rfc3339
from wayline_dashboard.core import DashboardCore, Seen
from wayline_dashboard.view import FleetView, VehicleView


@dataclass(slots=True)
class Cursor:
    """One page's place in the fleet's changes; a new one has seen nothing."""

    turn: int = -1
    shared: int = 0
    seen: dict[str, Seen] = field(default_factory=dict)


class Fleet:
    """One core a vehicle, made when it is first heard; the fleet's own services apart.

    The vehicle that changed last stands last in `_cores`, so a reader's turn costs what
    changed, not what exists. A slow reader reads seldom and then gets the newest of each
    section: nothing is queued for it.
    """

    def __init__(self) -> None:
        self._cores: dict[str, DashboardCore] = {}
        self._turns: dict[str, int] = {}
        self._heard_ns: dict[str, int] = {}
        self._turn = 0
        self._shared = DashboardCore(FLEET)

    def handle(self, vehicle_id: str, message: msgspec.Struct, source: str, heard_ns: int) -> None:
        """Give an input, heard at an instant of the wall clock, to its vehicle's core."""
        core = self._shared if vehicle_id == FLEET else self._core(vehicle_id)
        before = core.revision
        core.handle(message, source)
        if core.revision != before:
            self._turn += 1
            if core is not self._shared:
                self._cores[vehicle_id] = self._cores.pop(vehicle_id)
                self._turns[vehicle_id] = self._turn
                if isinstance(message, Pose):
                    self._heard_ns[vehicle_id] = heard_ns

    def snapshot(self, now_ns: int) -> FleetView:
        """Everything known, vehicles by id."""
        return FleetView(
            kind="snapshot",
            now=rfc3339(now_ns),
            vehicles=tuple(self._view(name, Seen()) for name in sorted(self._cores)),
            services=self._shared.services(),
        )

    def read(self, cursor: Cursor, now_ns: int) -> FleetView | None:
        """What is new to a reader: first a snapshot, then changes, None when there are none.

        Moves the cursor on.
        """
        first, turn = cursor.turn < 0, cursor.turn
        if turn == self._turn:
            return None
        services = self._shared.services() if self._shared.revision > cursor.shared else None
        view = FleetView(
            kind="snapshot" if first else "changes",
            now=rfc3339(now_ns),
            vehicles=self._changed_since(cursor),
            services=services,
        )
        cursor.turn, cursor.shared = self._turn, self._shared.revision
        return view

    def _core(self, vehicle_id: str) -> DashboardCore:
        core = self._cores.get(vehicle_id)
        if core is None:
            core = self._cores[vehicle_id] = DashboardCore(vehicle_id)
            self._turns[vehicle_id] = self._turn
        return core

    def _changed_since(self, cursor: Cursor) -> tuple[VehicleView, ...]:
        changed = []
        for vehicle_id in reversed(self._cores):
            if self._turns[vehicle_id] <= cursor.turn:
                break
            changed.append(self._view(vehicle_id, cursor.seen.get(vehicle_id, Seen())))
            cursor.seen[vehicle_id] = self._cores[vehicle_id].seen()
        return tuple(reversed(changed))

    def _view(self, vehicle_id: str, seen: Seen) -> VehicleView:
        view = self._cores[vehicle_id].changes(seen)
        if view.pose is not None and vehicle_id in self._heard_ns:
            view.heard = rfc3339(self._heard_ns[vehicle_id])
        return view
