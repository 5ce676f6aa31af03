"""Pure: forecasts one vehicle's arrivals on one route, and learns from how they come."""

from collections.abc import Sequence

from wayline.messages import StopEvent
from wayline.route import Route
from wayline_eta import leg_times
from wayline_eta.arrivals import Floats, Outlook, Visit, predict_visits
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.forecasts import Forecast, Forecasts
from wayline_eta.leg_times import LegTimes
from wayline_eta.legs import Legs
from wayline_eta.lessons import Forecasting, Lessons
from wayline_eta.records import Came, Learned, Taken


class Forecaster:
    """Of one vehicle, as long as it follows one route or runs one trip.

    `scope` names whose stop ids the route has, `plan` whose times, `sequences` the stops in stop
    events.
    """

    def __init__(
        self, route: Route, lessons: Lessons, *, scope: str, plan: str, sequences: Sequence[int]
    ) -> None:
        self._legs, self._lessons, self._plan = Legs(route, scope), lessons, plan
        self._times = LegTimes(self._legs, list(sequences))
        self._forecasts = Forecasts()

    def visits(
        self,
        outlook: Outlook,
        leaves_ns: Floats | None = None,
        motion: ExpectedMotion | None = None,
    ) -> list[Visit]:
        """The visits still to come; they are remembered until they have."""
        visits = predict_visits(self._by(outlook.t_ns), outlook, leaves_ns, motion)
        for visit in visits:
            if visit.arrival_s > 0.0:
                forecast = Forecast(
                    outlook.t_ns,
                    outlook.t_ns + round(visit.arrival_s * 1e9),
                    round(visit.early_width_s * 1e9),
                    round(visit.late_width_s * 1e9),
                )
                self._forecasts.make(visit.stop, forecast)
        return visits

    def learn(self, happened: Sequence[StopEvent]) -> list[Learned]:
        """Take what the vehicle did at stops; what that has taught."""
        learned = []
        for event in happened:
            taken = self._times.observe(event)
            if taken is not None:
                learned.append(self._learned(taken))
                self._lessons.learn(learned[-1])
        return learned

    def _by(self, t_ns: int) -> Forecasting:
        lessons = self._lessons
        return Forecasting(
            self._legs,
            self._plan,
            lessons.experience,
            lessons.ranges_of(self._plan),
            self._times.stands(t_ns),
        )

    def _learned(self, driven: leg_times.Taken) -> Learned:
        leg, stop = driven.leg, self._legs.keys[driven.stop]
        taken = Taken(
            t_ns=driven.arrived_ns,
            leg=None if leg is None else leg.key,
            plan=self._plan,
            planned_s=0.0 if leg is None else leg.planned_s,
            travel_s=driven.travel_s,
            stop=stop,
            dwell_s=driven.dwell_s,
        )
        came = self._forecasts.arrive(driven.stop, driven.arrived_ns)
        return Learned(
            taken=taken,
            came=tuple(Came(each.made_ns, stop, self._plan, each.span, each.off) for each in came),
        )
