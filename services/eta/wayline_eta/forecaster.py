"""Pure: forecasts one vehicle's arrivals on one route, and learns from how they come."""

from collections.abc import Sequence

from wayline.messages import StopEvent
from wayline.route import Route
from wayline_eta import leg_times
from wayline_eta.arrivals import Outlook, Visit, predict_visits
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.forecasts import Forecast, Forecasts
from wayline_eta.leg_times import LegTimes
from wayline_eta.legs import Legs
from wayline_eta.lessons import Expectations, Lessons, expectations
from wayline_eta.records import Came, Learned, Taken
from wayline_eta.stands import Stand, goes_on

RENEWED_NS = 10_000_000_000
"""What others teach is taken up so often, and at once after each stop of one's own."""
FADED_NS = 60_000_000_000
"""Where nobody has taught anything: traffic that was noticed fades, and half hours pass."""
DWELLS_SEEN = 2.0
"""At a stop, before they count for a vehicle that stands there."""


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
        self._expected: Expectations | None = None
        self._renewed_ns = self._taught = 0
        """When that was reckoned, and how much had been taught by then."""

    def visits(
        self, outlook: Outlook, now_ns: int, motion: ExpectedMotion | None = None
    ) -> list[Visit]:
        """The visits still to come; they are remembered until they have."""
        by = self._expectations(now_ns)
        outlook = outlook._replace(stand=self._stand(by, outlook, motion))
        visits = predict_visits(by, outlook, now_ns, motion)
        if self._forecasts.is_due(now_ns):
            for visit in visits:
                width_ns = visit.early_width_ns, visit.late_width_ns
                self._forecasts.make(visit.stop, Forecast(now_ns, visit.arrival_ns, *width_ns))
        return visits

    def learn(self, happened: Sequence[StopEvent]) -> list[Learned]:
        """Take what the vehicle did at stops; what that has taught."""
        learned = []
        for event in happened:
            taken = self._times.observe(event)
            if taken is not None:
                learned.append(self._learned(taken))
                self._lessons.learn(learned[-1])
                self._expected = None
        return learned

    def _expectations(self, t_ns: int) -> Expectations:
        age_ns, lessons = t_ns - self._renewed_ns, self._lessons
        due_ns = RENEWED_NS if lessons.taught != self._taught else FADED_NS
        if self._expected is None or age_ns >= due_ns:
            self._expected = expectations(lessons, self._legs, self._plan, t_ns)
            self._renewed_ns, self._taught = t_ns, lessons.taught
        return self._expected

    def _stand(self, by: Expectations, outlook: Outlook, motion: ExpectedMotion | None) -> Stand:
        """How long it will still stand: at a stop without a time as long as others have stood."""
        stands = self._times.stands(outlook.t_ns)
        if stands is None or motion is not None or by.dwells_seen[stands[0]] < DWELLS_SEEN:
            return outlook.stand
        stop, stood_s = stands
        dwell_s = float(by.dwell_s[stop])
        return goes_on(max(stood_s - dwell_s, 0.0)).at_least(max(dwell_s - stood_s, 0.0))

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
