"""Pure: one vehicle's view model, kept from the messages of its bus topics."""

from collections.abc import Set
from itertools import chain

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
from wayline.rfc3339 import rfc3339
from wayline.view import Receipt
from wayline_dashboard.instant import Instant
from wayline_dashboard.roll import Roll
from wayline_dashboard.sections import (
    arrivals_view,
    fix_view,
    horizon_view,
    newest_rejection,
    pose_view,
    progress_view,
    status_view,
)
from wayline_dashboard.trail import Trail
from wayline_dashboard.view import ServiceView, VehicleView

SHOWN: frozenset[type[Message]] = frozenset(
    {Pose, GpsFix, FusionStatus, Progress, Arrivals, Horizon, Health}
)
"""Topics that the page shows the newest message of; of `Health` each service's newest."""
UNTOLD = -1
"""The revision that a reader knows who was told nothing."""
RESTART_NS = 10_000_000_000
"""A message older than the newest by more is no late one: a drive is played from its start."""


class VehicleViewModel:
    """Holds the newest message of each topic; a view is made only when somebody asks.

    So a 10 Hz pose costs a dictionary entry, however many pages look. Whoever puts something in
    numbers it with a revision that only grows. A reader that names the last revision it knows
    gets what changed since, and one that asks seldom gets the newest of each section once.
    """

    def __init__(self, vehicle_id: str) -> None:
        self.vehicle_id = vehicle_id
        self.revision = 0
        """Of the newest change."""
        self._first_revision: int | None = None
        self._newest: dict[type[Message], Message] = {}
        self._changed: dict[type[Message], int] = {}
        self._trail = Trail()
        self._pose_receipt = Receipt(0)
        self._fix_source = ""
        self._last_rejection: str | None = None
        self._roll = Roll()

    def put(self, message: Message, source: str, receipt: Receipt, revision: int) -> bool:
        """Keep what the page shows; False where nothing changed by it."""
        if type(message) not in SHOWN:
            return False
        if isinstance(message, Health):
            is_news = self._roll.hear(message)
        else:
            is_news = self._keep(message, source, receipt, revision)
        if is_news:
            self._touch(type(message), revision)
        return is_news

    def put_service(self, service: str, up: bool, revision: int) -> bool:
        """Take a service's liveliness token that came or went; False where nothing changed."""
        is_news = self._roll.note(service, is_up=up)
        if is_news:
            self._touch(Health, revision)
        return is_news

    def has_news(self, known: int, topics: Set[type[Message]]) -> bool:
        """Whether a reader that knows a revision lacks one of the topics, or the vehicle itself."""
        newest = chain([self._first_revision or 0], map(self._changed_at, topics))
        return max(newest) > known

    def view(self, known: int, topics: Set[type[Message]], now: Instant) -> VehicleView:
        """What of the topics changed since a revision, without the trail."""
        view = VehicleView(vehicle_id=self.vehicle_id)
        for topic in topics:
            if self._changed_at(topic) > known:
                self._fill(view, topic, now)
        return view

    def whole_view(self, known: int, now: Instant) -> VehicleView:
        """All that changed since a revision, the trail's new points too."""
        view = self.view(known, SHOWN, now)
        view.trail = self._trail.since(known)
        view.trail_restart = self._trail.is_missed(known)
        if view.trail_restart and (began_ns := self._trail.began_ns) is not None:
            view.trail_began = rfc3339(began_ns)
        return view

    def services(self) -> tuple[ServiceView, ...]:
        """Every service heard of, by name."""
        return self._roll.views()

    def _keep(self, message: Message, source: str, receipt: Receipt, revision: int) -> bool:
        topic = type(message)
        newest = self._newest.get(topic)
        if newest is not None and message.t_ns < newest.t_ns:
            if newest.t_ns - message.t_ns < RESTART_NS:
                return False  # recovered late: the page shows the present
            if isinstance(message, Pose):
                self._trail.clear(revision)
        self._newest[topic] = message
        if isinstance(message, Pose):
            self._pose_receipt = receipt
            self._trail.add(message, revision)
        elif isinstance(message, GpsFix):
            self._fix_source = source
        elif isinstance(message, FusionStatus):
            self._last_rejection = newest_rejection(message) or self._last_rejection
        return True

    def _touch(self, topic: type[Message], revision: int) -> None:
        self.revision = self._changed[topic] = revision
        if self._first_revision is None:
            self._first_revision = revision

    def _changed_at(self, topic: type[Message]) -> int:
        return self._changed.get(topic, UNTOLD)

    def _fill(self, view: VehicleView, topic: type[Message], now: Instant) -> None:
        match self._newest.get(topic):
            case Pose() as pose:
                view.pose, view.heard = pose_view(pose), now.heard(self._pose_receipt)
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
