"""What eta knows of all vehicles, shared by the thread that hears the bus with those that answer.

One thread calls `put`, any others the rest. The lock is held for microseconds: nothing is
computed or encoded under it.
"""

import threading
import time
from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated, ClassVar

import msgspec
from msgspec import Meta

from wayline.messages import LIST_MAX, GpsFix, Message, Pose
from wayline.parameters import read_parameters
from wayline.query_error import QueryError
from wayline.view import Clock, Receipt
from wayline_eta.answers import (
    ArrivalAnswer,
    ArrivalList,
    VehicleAnswer,
    VehicleList,
    arrival_answers,
    soonest_first,
    vehicle_answer,
)
from wayline_eta.known import Known

NO_PARAMETERS: Mapping[str, str] = MappingProxyType({})


class ArrivalsParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What a question for a vehicle's arrivals may say."""

    stop_id: (
        Annotated[str, Meta(description="Only the arrival at this stop")] | msgspec.UnsetType
    ) = msgspec.UNSET


class StopArrivalsParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What a question for the arrivals at a stop may say."""

    route_id: Annotated[str, Meta(description="Only of this route")] | msgspec.UnsetType = (
        msgspec.UNSET
    )
    minutes: (
        Annotated[float, Meta(gt=0.0, le=1440.0, description="Only those due within so long")]
        | msgspec.UnsetType
    ) = msgspec.UNSET
    limit: Annotated[int, Meta(ge=1, le=LIST_MAX, description="So many at most")] = 100

    def asks_for(self, arrival: ArrivalAnswer) -> bool:
        """Whether an arrival is one of those."""
        if self.route_id is not msgspec.UNSET and arrival.route_id != self.route_id:
            return False
        return self.minutes is msgspec.UNSET or arrival.seconds <= 60.0 * self.minutes


EVERYTHING = StopArrivalsParameters()


class EtaBoard:
    """The newest messages of every vehicle; `clock_ns` is the clock of the receipts.

    What is stale and what is forgotten, the core has decided.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset({Pose, GpsFix})

    def __init__(self, clock_ns: Clock = time.monotonic_ns) -> None:
        self.clock_ns = clock_ns
        self._lock = threading.Lock()
        self._vehicles: dict[str, Known] = {}

    def put(self, vehicle_id: str, message: Message, source: str, receipt: Receipt) -> None:
        """Take a message of a vehicle; those that `Known` does not keep are ignored."""
        with self._lock:
            known = self._vehicles.get(vehicle_id, Known())
            now = known.with_message(message, source, receipt)
            if now is not known:
                self._vehicles[vehicle_id] = now

    def forget(self, vehicle_id: str) -> None:
        """Drop a vehicle that has been silent for long."""
        with self._lock:
            self._vehicles.pop(vehicle_id, None)

    def vehicle_ids(self) -> list[str]:
        """Every vehicle that was heard and not yet forgotten."""
        with self._lock:
            return sorted(self._vehicles)

    def vehicle(self, vehicle_id: str) -> VehicleAnswer:
        """One vehicle. Raises QueryError (404) for one that is not known."""
        known, now_ns = self._look(vehicle_id)
        return vehicle_answer(vehicle_id, known, now_ns)

    def vehicles(self) -> VehicleList:
        """All vehicles by id."""
        vehicles, now_ns = self.look_at_all()
        answers = (vehicle_answer(name, vehicles[name], now_ns) for name in sorted(vehicles))
        return VehicleList(tuple(answers))

    def arrivals(self, vehicle_id: str, stop_id: str | None = None) -> ArrivalList:
        """One vehicle's next arrivals, at one stop or all, soonest first.

        Raises QueryError (404) for a vehicle that was never heard.
        """
        known, now_ns = self._look(vehicle_id)
        return soonest_first(arrival_answers(vehicle_id, known, now_ns, stop_id))

    def told_of(self, vehicle_id: str) -> tuple[int, int] | None:
        """What a vehicle's arrivals rest on now: their instant, and that of their receipt."""
        with self._lock:
            known = self._vehicles.get(vehicle_id, Known())
        told = known.arrivals
        return None if told is None else (told.message.t_ns, told.receipt.at_ns)

    def stop_arrivals(
        self, stop_id: str, asked: StopArrivalsParameters = EVERYTHING
    ) -> ArrivalList:
        """The next arrival of every vehicle at a stop, soonest first."""
        vehicles, now_ns = self.look_at_all()
        found = [
            at
            for vehicle_id, known in vehicles.items()
            for at in arrival_answers(vehicle_id, known, now_ns, stop_id)
            if asked.asks_for(at)
        ]
        return ArrivalList(soonest_first(found).arrivals[: asked.limit])

    def _look(self, vehicle_id: str) -> tuple[Known, int]:
        with self._lock:
            known, now_ns = self._vehicles.get(vehicle_id), self.clock_ns()
        if known is None:
            raise QueryError(404, f"no vehicle {vehicle_id} was heard; /v1/vehicles lists them")
        return known, now_ns

    def look_at_all(self) -> tuple[dict[str, Known], int]:
        """All vehicles by id, and the instant of the receipts' clock that this is of."""
        with self._lock:
            return dict(self._vehicles), self.clock_ns()


def answer_arrivals(
    board: EtaBoard, vehicle_id: str, parameters: Mapping[str, str] = NO_PARAMETERS
) -> ArrivalList:
    """A vehicle's next arrivals, for HTTP and for the queryable `@query/arrivals` alike.

    `parameters` are those of the URL or selector (`ArrivalsParameters`); others are ignored.
    Raises QueryError: 404 for a vehicle that was never heard, 422 for an unfit parameter.
    """
    asked = read_parameters(parameters, ArrivalsParameters)
    return board.arrivals(vehicle_id, None if asked.stop_id is msgspec.UNSET else asked.stop_id)
