"""Pure: the view models of all vehicles, and what a reader has not been told of them yet."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import takewhile

from wayline.keys import FLEET
from wayline.messages import Horizon, Message, Pose
from wayline.view import Receipt
from wayline_dashboard.instant import Instant
from wayline_dashboard.view import FleetView, VehicleView
from wayline_dashboard.view_model import SHOWN, UNTOLD, VehicleViewModel

LISTED: frozenset[type[Message]] = frozenset({Pose})
"""What a page shows of every vehicle, in its list and on its map."""
BRIEF = SHOWN - {Horizon}
"""What a snapshot tells of a vehicle that is not selected: most of a whole view is its horizon."""
GONE_MAX = 1000
"""Vehicles remembered as gone; a reader that missed more gets a snapshot."""


@dataclass(slots=True)
class Cursor:
    """One page's place in the fleet's changes and the vehicle it shows; a new one knows nothing."""

    known: int = UNTOLD
    selected: str | None = None
    known_of_selected: int = UNTOLD

    def select(self, vehicle_id: str | None) -> None:
        """Show another vehicle, of which nothing but what is listed was told yet."""
        if vehicle_id != self.selected:
            self.selected, self.known_of_selected = vehicle_id, UNTOLD


class Fleet:
    """One view model a vehicle, made when it is first heard; the fleet's own services apart.

    Every change has the next revision. The vehicle that changed last stands last in `_models`,
    so a reader's turn costs what changed, not what exists. A slow reader reads seldom and then
    gets the newest of each section: nothing is queued for it.
    """

    def __init__(self) -> None:
        self._models: dict[str, VehicleViewModel] = {}
        self._shared = VehicleViewModel(FLEET)
        self._revision = 0
        self._gone: dict[str, int] = {}
        """By revision, the newest last."""
        self._gone_unknown = UNTOLD
        """Of the newest that is no longer in `_gone`."""

    def put(self, vehicle_id: str, message: Message, source: str, receipt: Receipt) -> None:
        """Give a message to its vehicle's view model."""
        model = self._model(vehicle_id) or VehicleViewModel(vehicle_id)
        if model.put(message, source, receipt, self._revision + 1):
            self._note_change(model)

    def put_service(self, vehicle_id: str, service: str, up: bool) -> None:
        """Take a service that came or went. One that goes makes no vehicle known."""
        model = self._model(vehicle_id)
        if model is None and not up:
            return
        model = model or VehicleViewModel(vehicle_id)
        if model.put_service(service, up, self._revision + 1):
            self._note_change(model)

    def forget(self, vehicle_id: str) -> None:
        """Drop a vehicle; readers are told that it is gone."""
        if self._models.pop(vehicle_id, None) is None:
            return
        self._revision += 1
        self._gone.pop(vehicle_id, None)
        self._gone[vehicle_id] = self._revision
        if len(self._gone) > GONE_MAX:
            self._gone_unknown = self._gone.pop(next(iter(self._gone)))

    def knows(self, vehicle_id: str) -> bool:
        """Whether the vehicle was heard and not forgotten since."""
        return vehicle_id in self._models

    def snapshot(self, selected: str | None, now: Instant) -> FleetView:
        """All vehicles by id: the selected one whole, of the others what is `BRIEF`."""
        return FleetView(
            kind="snapshot",
            now=now.text,
            selected=selected,
            vehicles=tuple(
                model.whole_view(UNTOLD, now)
                if vehicle_id == selected
                else model.view(UNTOLD, BRIEF, now)
                for vehicle_id, model in sorted(self._models.items())
            ),
            gone=(),
            services=self._shared.services(),
        )

    def read(self, cursor: Cursor, now: Instant) -> FleetView | None:
        """What is new to a reader: first a snapshot, then changes, None when there are none.

        Of the selected vehicle everything, of the others what is `LISTED`. Moves the cursor on.
        """
        if cursor.known < self._gone_unknown:
            cursor.known = cursor.known_of_selected = UNTOLD
        is_first, has_selected = cursor.known == UNTOLD, cursor.known_of_selected == UNTOLD
        view = FleetView(
            kind="snapshot" if is_first else "changes",
            now=now.text,
            selected=cursor.selected,
            vehicles=tuple(self._news(cursor, now)),
            gone=() if is_first else tuple(self._gone_since(cursor.known)),
            services=self._shared.services() if self._shared.revision > cursor.known else None,
        )
        cursor.known = cursor.known_of_selected = self._revision
        is_news = is_first or has_selected or view.vehicles or view.gone
        return view if is_news or view.services is not None else None

    def _model(self, vehicle_id: str) -> VehicleViewModel | None:
        return self._shared if vehicle_id == FLEET else self._models.get(vehicle_id)

    def _note_change(self, model: VehicleViewModel) -> None:
        self._revision = model.revision
        if model is not self._shared:
            self._models.pop(model.vehicle_id, None)
            self._models[model.vehicle_id] = model

    def _news(self, cursor: Cursor, now: Instant) -> Iterator[VehicleView]:
        newest_first = reversed(self._models.values())
        for model in takewhile(lambda each: each.revision > cursor.known, newest_first):
            if model.vehicle_id != cursor.selected and model.has_news(cursor.known, LISTED):
                yield model.view(cursor.known, LISTED, now)
        selected = self._models.get(cursor.selected or "")
        if selected is not None and selected.revision > cursor.known_of_selected:
            yield selected.whole_view(cursor.known_of_selected, now)

    def _gone_since(self, known: int) -> Iterator[str]:
        newest_first = reversed(self._gone.items())
        for vehicle_id, _ in takewhile(lambda each: each[1] > known, newest_first):
            yield vehicle_id
