"""Arrivals and progress of vehicles as server-sent events, at the pace that a reader takes."""

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator
from dataclasses import dataclass, field
from typing import Annotated

import msgspec
from fastapi.sse import format_sse_event
from msgspec import UNSET, Meta

from wayline.messages import LIST_MAX, Arrivals, Progress
from wayline_eta.answers import (
    ArrivalAnswer,
    ProgressAnswer,
    arrival_answers,
    progress_answer,
    soonest_first,
)
from wayline_eta.board import EtaBoard, StopArrivalsParameters
from wayline_eta.known import Heard, Known
from wayline_eta.rendered import Rendered

PERIOD_S = 0.1
"""Vehicles tell once a second, each at its own instant."""
HEARTBEAT_S = 5.0
HEARTBEAT = format_sse_event(comment="nothing new")


class StreamParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What a question for the stream may say."""

    vehicle_id: Annotated[str, Meta(description="Only of this vehicle")] | msgspec.UnsetType = UNSET
    route_id: Annotated[str, Meta(description="Only of this route")] | msgspec.UnsetType = UNSET
    stop_id: (
        Annotated[str, Meta(description="Only the arrivals at this stop")] | msgspec.UnsetType
    ) = UNSET
    minutes: (
        Annotated[float, Meta(gt=0.0, le=1440.0, description="Only arrivals due within so long")]
        | msgspec.UnsetType
    ) = UNSET
    limit: Annotated[int, Meta(ge=1, le=LIST_MAX, description="Arrivals of an event")] = 100


class VehicleArrivals(msgspec.Struct, frozen=True, kw_only=True):
    """The event `arrivals`: a vehicle's next arrivals that are asked for, soonest first."""

    vehicle_id: str
    arrivals: tuple[ArrivalAnswer, ...]


class VehicleProgress(msgspec.Struct, frozen=True, kw_only=True):
    """The event `progress`: where a vehicle is along its route."""

    vehicle_id: str
    on_route: bool
    progress: ProgressAnswer


@dataclass(slots=True)
class Sent:
    """What a reader has of a vehicle."""

    progress: Heard[Progress] | None = None
    arrivals: Heard[Arrivals] | None = None
    is_expected: bool = False
    """The last arrivals were some."""


@dataclass(slots=True)
class Reader:
    """One of the stream's, with what it asks for and what it has."""

    board: EtaBoard
    rendered: Rendered
    asked: StreamParameters
    sent: dict[str, Sent] = field(default_factory=dict)

    def news(self) -> Iterator[bytes]:
        """What vehicles have told since the last time, each its newest."""
        vehicles, now_ns = self.board.look_at_all()
        for vehicle_id in self.sent.keys() - vehicles.keys():
            del self.sent[vehicle_id]
        for vehicle_id in sorted(vehicles):
            if self.asked.vehicle_id in {UNSET, vehicle_id}:
                sent = self.sent.setdefault(vehicle_id, Sent())
                yield from self._progress(vehicle_id, vehicles[vehicle_id], sent)
                yield from self._arrivals(vehicle_id, vehicles[vehicle_id], sent, now_ns)

    def _progress(self, vehicle_id: str, known: Known, sent: Sent) -> Iterator[bytes]:
        heard = known.progress
        if heard is None or heard is sent.progress:
            return
        sent.progress, told = heard, heard.message
        if self.asked.route_id in {UNSET, told.route_id}:

            def make() -> VehicleProgress:
                return VehicleProgress(
                    vehicle_id=vehicle_id, on_route=told.on_route, progress=progress_answer(told)
                )

            basis = told.t_ns, heard.receipt.at_ns
            yield _event("progress", self.rendered.of_one(("progress", vehicle_id), basis, make))

    def _arrivals(self, vehicle_id: str, known: Known, sent: Sent, now_ns: int) -> Iterator[bytes]:
        """Those that are asked for; where there are none any longer, that once."""
        heard = known.arrivals
        if heard is None or heard is sent.arrivals:
            return
        sent.arrivals = heard

        def make() -> VehicleArrivals:
            stop_id = None if self.asked.stop_id is UNSET else self.asked.stop_id
            found = soonest_first(arrival_answers(vehicle_id, known, now_ns, stop_id)).arrivals
            chosen = tuple(filter(self._asks_for, found))[: self.asked.limit]
            return VehicleArrivals(vehicle_id=vehicle_id, arrivals=chosen)

        basis = heard.message.t_ns, heard.receipt.at_ns
        body = self.rendered.of_one(("arrivals", vehicle_id, self.asked), basis, make)
        was_expected, sent.is_expected = sent.is_expected, not body.endswith(b'"arrivals":[]}')
        if sent.is_expected or was_expected:
            yield _event("arrivals", body)

    def _asks_for(self, arrival: ArrivalAnswer) -> bool:
        asked = StopArrivalsParameters(route_id=self.asked.route_id, minutes=self.asked.minutes)
        return asked.asks_for(arrival)


async def stream(
    reader: Reader,
    is_ending: Callable[[], bool] = lambda: False,
    *,
    period_s: float = PERIOD_S,
    heartbeat_s: float = HEARTBEAT_S,
) -> AsyncIterator[bytes]:
    """All that is known, then what is new, until the reader or the service goes.

    Now and then it says that there is nothing new.
    Nothing is queued: whoever takes the bytes waits while the socket is full, and the next turn
    tells the newest. So a slow reader gets less and costs no memory.
    """
    loop = asyncio.get_running_loop()
    sent_s = loop.time()
    while not is_ending():
        if events := b"".join(reader.news()):
            yield events
            sent_s = loop.time()
        elif loop.time() - sent_s >= heartbeat_s:
            yield HEARTBEAT
            sent_s = loop.time()
        await asyncio.sleep(period_s)


def _event(name: str, body: bytes) -> bytes:
    return format_sse_event(event=name, data_str=body.decode())
