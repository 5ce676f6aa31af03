"""Pure: predicted arrivals with what the timetable says: scheduled times, departures, next trip."""

from collections.abc import Sequence
from itertools import takewhile

from wayline.messages import LIST_MAX, StopArrival, TripRun
from wayline.route import Route
from wayline.timetable.clock_times import clock_of_seconds
from wayline.timetable.runs import Run
from wayline_eta.arrivals import Visit
from wayline_eta.stands import Stand

SECOND_NS = 1_000_000_000


def of_run(run: Run, visits: Sequence[Visit]) -> tuple[StopArrival, ...]:
    """Predicted visits of a run with their scheduled times and the departures that follow."""
    route, arrivals_s = run.trip_route.route, run.trip_route.plan.arrivals_s
    return tuple(
        StopArrival(
            stop_id=route.stops[visit.stop].stop_id,
            name=route.stops[visit.stop].name,
            distance_m=visit.distance_m,
            arrival_ns=visit.arrival_ns,
            early_ns=visit.early_ns,
            late_ns=visit.late_ns,
            departure_ns=visit.departure_ns,
            scheduled_ns=_promised(run, _planned_ns(run, float(arrivals_s[visit.stop]))),
            confidence="learned" if visit.is_learned else "timetable",
            stop_sequence=run.trip_route.sequences[visit.stop],
        )
        for visit in visits
    )


def of_next_run(
    run: Run, before: Sequence[StopArrival], begins: Stand, visits: Sequence[Visit], t_ns: int
) -> tuple[StopArrival, ...]:
    """Arrivals of the block's next trip after those of the present one, each stop once.

    It `begins` so many seconds from an instant; the first stop is told by its departure.
    """
    end, route, plan = before[-1], run.trip_route.route, run.trip_route.plan
    early_ns, leaves_ns, late_ns = (t_ns + round(each * SECOND_NS) for each in begins)
    times = [Visit(0, 0.0, False, leaves_ns, early_ns, late_ns, leaves_ns, 0, 0), *visits]
    seen = {stop.stop_id for stop in before}
    found: dict[str, StopArrival] = {}
    for visit in times:
        at, stop = visit.stop, route.stops[visit.stop]
        if stop.stop_id in seen or len(seen) + len(found) >= LIST_MAX:
            continue
        time_s = plan.departures_s[at] if at == 0 else plan.arrivals_s[at]
        arrival = StopArrival(
            stop_id=stop.stop_id,
            name=stop.name,
            distance_m=end.distance_m + stop.distance_m,
            arrival_ns=visit.arrival_ns,
            early_ns=visit.early_ns,
            late_ns=visit.late_ns,
            departure_ns=visit.departure_ns,
            scheduled_ns=_promised(run, _planned_ns(run, float(time_s))),
            trip_id=run.trip.trip_id,
            confidence="learned" if visit.is_learned else "timetable",
            stop_sequence=run.trip_route.sequences[at],
        )
        found.setdefault(stop.stop_id, arrival)
    return tuple(found.values())


def told_run(run: Run) -> TripRun:
    """A run as it is told."""
    direction_id = run.pattern.direction_id
    return TripRun(
        trip_id=run.trip.trip_id,
        route_id=run.pattern.route_id,
        direction_id=None if direction_id is None else 1 if direction_id else 0,
        start_date=run.day.strftime("%Y%m%d"),
        start_time=None if run.repeat_s is None else clock_of_seconds(run.repeat_s),
        exact=run.is_exact,
    )


def _planned_ns(run: Run, time_s: float) -> int:
    return run.starts_ns + round(time_s * SECOND_NS)


def _promised(run: Run, scheduled_ns: int) -> int | None:
    """Null where only the time between two vehicles is promised."""
    return scheduled_ns if run.is_exact else None


def before_the_fork(
    told: Sequence[StopArrival], rivals: Sequence[Route]
) -> tuple[StopArrival, ...]:
    """The arrivals up to the first stop that a rival line does not serve."""
    if not rivals:
        return tuple(told)
    served = [{stop.stop_id for stop in route.stops} for route in rivals]
    return tuple(takewhile(lambda stop: all(stop.stop_id in each for each in served), told))
