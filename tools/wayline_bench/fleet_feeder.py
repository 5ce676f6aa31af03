"""The process that plays a fleet on the bus, and reads meanwhile what the listeners spend."""

import contextlib
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from wayline.bus import Publishers, open_session
from wayline.codec import encode
from wayline.settings import BusSettings
from wayline_bench.fleet_bare import BarePublishers
from wayline_bench.fleet_costs import Costs, core_shares, costs
from wayline_bench.fleet_figures import Fed, Load
from wayline_bench.fleet_vehicle import TOLD_HZ, Vehicle, ring

VEHICLES_A_SESSION = 25
ARRIVE_S = 6.0
"""The vehicles come one after another, as a fleet in the morning, only faster."""
WARM_UP_S = 2.0
HOLD_S = 6.0
"""Advanced publishers stay so long after their last message that its loss would be noticed."""

Put = Callable[[str, str, str, bytes], None]
"""Vehicle, topic, source, payload."""


@dataclass(frozen=True)
class FleetFeed:
    """What to send, for how long, and whose costs to read."""

    bus: BusSettings
    pids: Mapping[str, int]
    load: Load
    is_bare: bool = False
    """Played by plain publishers, for the yardstick."""


def vehicle_name(number: int) -> str:
    """Id of a vehicle of the fleet."""
    return f"fleet-{number}"


class Turn(NamedTuple):
    """A vehicle's turn to speak."""

    number: int
    tick: int
    at_ticks: float
    """When, counted in ticks from the first one's begin."""


def turns(vehicles: int, ticks: int, *, arriving: bool) -> Iterator[Turn]:
    """Every vehicle once a tick, spread evenly over it; while they arrive, each tick brings more.

    A vehicle that has come speaks at every tick from then on, and at the last one all are there.
    """
    for tick in range(ticks):
        for number in range(vehicles):
            if not arriving or number % ticks <= tick:
                yield Turn(number, tick, tick + number / vehicles)


def feed(plan: FleetFeed) -> Fed:
    """Let the fleet come, warm the listeners up, then play the rounds."""
    with contextlib.ExitStack() as stack:
        puts = []
        for _ in range(-(-plan.load.vehicles // VEHICLES_A_SESSION)):
            session = stack.enter_context(open_session(plan.bus))
            publishers = BarePublishers(session) if plan.is_bare else Publishers(session)
            stack.callback(publishers.close)
            puts.append(publishers.put)
        fed = _Feeder(plan, puts).play()
        if not plan.is_bare:
            time.sleep(HOLD_S)
    return fed


class _Feeder:
    """Plays a plan; each vehicle has its own phase, so that the messages are spread evenly."""

    def __init__(self, plan: FleetFeed, puts: Sequence[Put]) -> None:
        self._plan, self._puts, self._fed = plan, puts, Fed()
        self._ticks_a_telling = round(plan.load.pose_hz / TOLD_HZ)
        route, now_ns = ring(), time.time_ns()
        spacing_m = route.length_m / plan.load.vehicles
        self._vehicles = [Vehicle(route, n * spacing_m, now_ns) for n in range(plan.load.vehicles)]

    def play(self) -> Fed:
        """What came of it."""
        plan, fed = self._plan, self._fed
        before = costs(plan.pids)
        start_s = time.monotonic()
        self._round(start_s, ARRIVE_S, arriving=True)
        self._round(start_s + ARRIVE_S, WARM_UP_S)
        first_s = start_s + ARRIVE_S + WARM_UP_S
        fed.late_s, fed.rounds_began_s = 0.0, time.monotonic()
        for number in range(plan.load.rounds):
            began, began_s = costs(plan.pids), time.monotonic()
            self._round(first_s + number * plan.load.round_s, plan.load.round_s)
            after = costs(plan.pids)
            fed.core_shares.append(core_shares(began, after, time.monotonic() - began_s))
            fed.rounds_ended_s = time.monotonic()
        fed.memory_bytes = _growth(before, costs(plan.pids))
        return fed

    def _round(self, began_s: float, length_s: float, *, arriving: bool = False) -> None:
        """So many seconds of the fleet."""
        pose_hz = self._plan.load.pose_hz
        ticks = round(length_s * pose_hz)
        for turn in turns(self._plan.load.vehicles, ticks, arriving=arriving):
            due_s = began_s + turn.at_ticks / pose_hz
            time.sleep(max(due_s - time.monotonic(), 0.0))
            self._fed.late_s = max(self._fed.late_s, time.monotonic() - due_s)
            self._say(turn.number, pose_only=turn.tick % self._ticks_a_telling != 0)
        time.sleep(max(began_s + length_s - time.monotonic(), 0.0))

    def _say(self, number: int, *, pose_only: bool) -> None:
        name, put = vehicle_name(number), self._puts[number // VEHICLES_A_SESSION]
        for source, message in self._vehicles[number].say(time.time_ns(), pose_only=pose_only):
            put(name, message.topic, source, encode(message))
            self._fed.sent[message.topic] += 1


def _growth(before: Costs, after: Costs) -> dict[str, int]:
    return {name: after.memory_bytes[name] - held for name, held in before.memory_bytes.items()}
