"""What was told of arrivals beside what could be told by who knows more than eta ever can.

Of a simulated network's bus that is who is told its streets; of a loop with a truth who knows how
long all other laps took. Both are asked once a minute, of the stops of the trip or lap under way.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from zoneinfo import ZoneInfo

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.errors import InputError
from wayline.messages import Arrivals, Progress, StopArrival, StopEvent
from wayline.route import Route
from wayline.timetable.calendar import SECOND_NS, instant_ns
from wayline_evaluation.eta import EVERY_NS, Beside
from wayline_evaluation.other_laps import OtherLaps
from wayline_evaluation.reference import Reference
from wayline_evaluation.told_streets import ToldStreets
from wayline_simulator.network.files import DayFacts, read_day_facts
from wayline_simulator.network.model import ZONE
from wayline_simulator.network.simulation import make_network, ride_of, traffic_of

Floats = NDArray[np.float64]
Ask = Callable[[Arrivals], dict[str, Floats]]
"""When the vehicle may come to the stops ahead, by stop, in Unix seconds."""

LAPS_MIN = 2
"""So many laps are driven to an end, so that one more is known beside each."""


def asked(told: Sequence[Arrivals], ask: Ask) -> Beside:
    """What was told once a minute, beside the yardstick's: the median, and from p10 to p90."""
    kept, others = [], []
    for each in told:
        if each.stale or each.t_ns % EVERY_NS:
            continue
        may_come_s = ask(each)
        stops = [one for one in each.stops if one.trip_id is None and one.stop_id in may_come_s]
        arrivals = [_arrival(stop, may_come_s[stop.stop_id]) for stop in stops]
        kept.append(msgspec.structs.replace(each, stops=tuple(stops)))
        others.append(msgspec.structs.replace(each, stops=tuple(arrivals)))
    return Beside(kept, others)


def _arrival(stop: StopArrival, may_come_s: Floats) -> StopArrival:
    early_ns, middle_ns, late_ns = (
        round(float(each) * SECOND_NS) for each in np.quantile(may_come_s, (0.1, 0.5, 0.9))
    )
    return msgspec.structs.replace(stop, arrival_ns=middle_ns, early_ns=early_ns, late_ns=late_ns)


def expect_yardstick(folder: Path, truth: Reference | None, routes: Sequence[Route]) -> None:
    """Raise InputError for a drive of which nobody can know more, before it is replayed."""
    loops_m = [route.length_m for route in routes if route.loop]
    driven_m = 0.0 if truth is None else float(truth.distances_m[-1])
    goes_round = bool(loops_m) and driven_m >= LAPS_MIN * min(loops_m)
    if not goes_round and read_day_facts(folder) is None:
        raise no_yardstick(folder)


def no_yardstick(folder: Path) -> InputError:
    """What is wrong with a drive that has none."""
    mend = "name drives of wayline simulate network, or several laps of a loop with a truth"
    return InputError(str(folder), "there is no yardstick for it", mend)


def told_streets(folder: Path) -> Ask | None:
    """Who is told the streets of a simulated network; None of any other drive."""
    facts = read_day_facts(folder)
    return None if facts is None else _of_day(facts)


def _of_day(facts: DayFacts) -> Ask:
    model, random = facts.network, np.random.default_rng(facts.vehicle)
    network = make_network(model)
    traffic = traffic_of(model, network, facts.number)
    ride = ride_of(model, network, traffic, facts.vehicle)
    midnight_s = instant_ns(traffic.day, 0.0, ZoneInfo(ZONE)) // SECOND_NS
    stages = () if ride is None else ride.stages

    def ask(told: Arrivals) -> dict[str, Floats]:
        time_s = told.t_ns / SECOND_NS - midnight_s
        for stage in stages:
            trip = stage.trip
            if trip is None or trip.trip_id != told.trip_id:
                continue
            if stage.begins_s <= time_s < stage.ends_s:
                found = ToldStreets(stage, trip, traffic).arrivals_s(time_s, random)
                return {stop_id: midnight_s + each_s for stop_id, each_s in found.items()}
        return {}

    return ask


def other_laps(progress: Sequence[Progress], events: Sequence[StopEvent]) -> Ask | None:
    """Who knows all other laps of a loop; None where there are none."""
    if not progress or max(each.lap for each in progress) < LAPS_MIN:
        return None
    laps = OtherLaps(progress, events)

    def ask(told: Arrivals) -> dict[str, Floats]:
        found = {
            stop.stop_id: laps.arrivals_s(stop.stop_id, told.t_ns / SECOND_NS)
            for stop in told.stops
        }
        return {stop_id: each_s for stop_id, each_s in found.items() if len(each_s)}

    return ask
