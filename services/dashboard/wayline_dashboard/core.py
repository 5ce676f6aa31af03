"""Pure: one vehicle's view model, kept from the messages of its bus topics."""

from collections.abc import Sequence
from typing import ClassVar

import msgspec

from wayline.core import Record
from wayline.messages import (
    Arrivals,
    FusionStatus,
    GpsFix,
    Health,
    Horizon,
    Message,
    Pose,
    Progress,
)
from wayline_dashboard.sections import (
    arrivals_view,
    fix_view,
    horizon_view,
    newest_rejection,
    pose_view,
    progress_view,
    service_view,
    status_view,
)
from wayline_dashboard.trail import Trail
from wayline_dashboard.view import ServiceView, VehicleView

KEPT: tuple[type[Message], ...] = (Pose, GpsFix, FusionStatus, Progress, Arrivals, Horizon)
"""Topics of which the page shows the newest message."""
RESTART_NS = 10_000_000_000
"""A message older than the newest by more is no late one: a drive is played from its start."""


class ServiceEvent(msgspec.Struct, frozen=True):
    """A service's liveliness token came or went."""

    service: str
    up: bool


class Seen(msgspec.Struct, frozen=True):
    """How much of a vehicle a reader has been told."""

    revision: int = 0
    trail_count: int = 0


class DashboardCore:
    """Holds the newest message of each topic; a view is made only when somebody asks.

    So a 10 Hz pose costs a dictionary entry, however many pages look. `revision` grows with
    every change; a reader that comes back with what it has `Seen` gets what changed since,
    and one that comes back late gets the newest of each section once.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset({*KEPT, Health})
    period_ns: ClassVar[int | None] = None

    def __init__(self, vehicle_id: str) -> None:
        self.vehicle_id = vehicle_id
        self.revision = 0
        self._newest: dict[type[Message], Message] = {}
        self._changed: dict[type[Message], int] = {}
        self._trail = Trail()
        self._fix_source = ""
        self._last_rejection: str | None = None
        self._up: dict[str, bool] = {}
        self._health: dict[str, Health] = {}

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
        """Keep what the page shows; nothing goes back to the bus. Ticks change nothing."""
        if isinstance(message, KEPT):
            self._keep(message, source)
        elif isinstance(message, Health):
            self._keep_health(message)
        elif isinstance(message, ServiceEvent):
            self._up[message.service] = message.up
            self._touch(Health)
        return []

    def snapshot(self) -> VehicleView:
        """Everything known of the vehicle."""
        return self.changes(Seen())

    def changes(self, seen: Seen) -> VehicleView:
        """What changed since; with `Seen()` everything."""
        view = VehicleView(vehicle_id=self.vehicle_id)
        for topic, revision in self._changed.items():
            if revision > seen.revision:
                self._fill(view, topic)
        view.trail = self._trail.since(seen.trail_count)
        view.trail_restart = seen.trail_count < self._trail.start
        return view

    def seen(self) -> Seen:
        """What a reader knows that has just been given `snapshot` or `changes`."""
        return Seen(self.revision, self._trail.count)

    def services(self) -> tuple[ServiceView, ...]:
        """Every service heard of, by name."""
        names = sorted(self._up.keys() | self._health.keys())
        # a health without a token seen (a replay, say) still speaks of a living service
        return tuple(
            service_view(name, self._up.get(name, True), self._health.get(name)) for name in names
        )

    def _keep(self, message: Message, source: str) -> None:
        topic = type(message)
        newest = self._newest.get(topic)
        if newest is not None and message.t_ns < newest.t_ns:
            if newest.t_ns - message.t_ns < RESTART_NS:
                return  # recovered late: the page shows the present
            if isinstance(message, Pose):
                self._trail.clear()
        self._newest[topic] = message
        self._touch(topic)
        if isinstance(message, Pose):
            self._trail.add(message)
        elif isinstance(message, GpsFix):
            self._fix_source = source
        elif isinstance(message, FusionStatus):
            self._last_rejection = newest_rejection(message) or self._last_rejection

    def _keep_health(self, health: Health) -> None:
        self._health[health.service] = health
        self._touch(Health)

    def _touch(self, topic: type[Message]) -> None:
        self.revision += 1
        self._changed[topic] = self.revision

    def _fill(self, view: VehicleView, topic: type[Message]) -> None:
        match self._newest.get(topic):
            case Pose() as pose:
                view.pose = pose_view(pose)
            case GpsFix() as fix:
                view.fix = fix_view(fix, self._fix_source)
            case FusionStatus() as status:
                view.status = status_view(status, self._last_rejection)
            case Progress() as progress:
                view.progress = progress_view(progress)
            case Arrivals() as arrivals:
                view.arrivals = arrivals_view(arrivals)
            case Horizon() as horizon:
                view.horizon = horizon_view(horizon)
            case _:
                view.services = self.services()
