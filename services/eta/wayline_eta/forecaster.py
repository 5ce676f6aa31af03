"""Pure: forecasts one vehicle's arrivals on one route, and learns from how they come."""

from wayline.route import Route
from wayline.tuning import Tuning
from wayline_eta.arrivals import Floats, Outlook, Visit, predict_visits
from wayline_eta.forecasts import Forecast, Forecasts
from wayline_eta.legs import Driven, LegObserver, Legs, Seen
from wayline_eta.lessons import Forecasting, Lessons
from wayline_eta.records import Came, Learned, Taken

GAP_S = 150.0
"""A vehicle that was not seen for longer may have been anywhere."""


class Forecaster:
    """Of one vehicle, as long as it follows one route (a timetable's run of one trip).

    `scope` names whose stop ids the route has, `plan` whose times. `waits` are the stops that a
    vehicle leaves by its timetable: how long it stands there teaches nothing.
    """

    def __init__(
        self, route: Route, lessons: Lessons, tuning: Tuning, *, scope: str, plan: str
    ) -> None:
        self._legs, self._lessons, self._plan = Legs(route, scope), lessons, plan
        self._observer = LegObserver(
            self._legs,
            radius_m=tuning.stop_radius_m,
            standing_mps=tuning.eta_standing_mps,
            gap_s=GAP_S,
        )
        self._forecasts = Forecasts()

    def visits(self, outlook: Outlook, leaves_ns: Floats | None = None) -> list[Visit]:
        """The visits still to come; they are remembered until they have."""
        visits = predict_visits(self._by(outlook.t_ns), outlook, leaves_ns)
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

    def observe(self, seen: Seen) -> Learned | None:
        """Take the vehicle's next place; what it has taught, once it has left a stop."""
        driven = self._observer.observe(seen)
        if driven is None:
            return None
        learned = self._learned(driven)
        self._lessons.learn(learned)
        return learned

    def _by(self, t_ns: int) -> Forecasting:
        lessons, observer = self._lessons, self._observer
        since_ns = observer.stands_since_ns
        return Forecasting(
            self._legs,
            self._plan,
            lessons.experience,
            lessons.ranges_of(self._plan),
            observer.stands_at,
            0.0 if since_ns is None else max(t_ns - since_ns, 0) * 1e-9,
        )

    def _learned(self, driven: Driven) -> Learned:
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
