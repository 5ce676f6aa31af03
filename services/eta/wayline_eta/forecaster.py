"""Pure: forecasts one vehicle's arrivals on one route, and learns from how they come."""

from collections.abc import Sequence

import msgspec
import numpy as np

from wayline.messages import Disruption, StopArrival, StopEvent
from wayline.route import Route
from wayline_eta import leg_times
from wayline_eta.arrivals import (
    NORMAL_P90,
    Outlook,
    Visit,
    later_of,
    next_stop,
    predict_visits,
    usual_s,
)
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.experience import is_wait
from wayline_eta.forecasts import Forecast, Forecasts
from wayline_eta.leg_times import LegTimes
from wayline_eta.legs import Legs
from wayline_eta.lessons import Expectations, Lessons, expectations
from wayline_eta.own_pace import OwnPace
from wayline_eta.records import Came, Learned, Taken
from wayline_eta.stands import Stand, rest_of_dwell

RENEWED_NS = 10_000_000_000
"""What others teach is taken up so often, and at once after each stop of one's own."""
FADED_NS = 60_000_000_000
"""Where nobody has taught anything: traffic that was noticed fades, and half hours pass."""
DWELLS_SEEN = 2.0
"""At a stop, before they count for a vehicle that stands there."""
UNKNOWN_STAND_S = 240.0
"""Where fewer were seen a stand is no breakdown that may be usual: a layover that no plan has."""


class Forecaster:
    """Of one vehicle, as long as it follows one route or runs one trip.

    `scope` names whose stop ids the route has, `plan` whose times, `sequences` the stops in stop
    events; `motion` is that of a timetable's trip.
    """

    def __init__(
        self,
        route: Route,
        lessons: Lessons,
        *,
        scope: str,
        plan: str,
        sequences: Sequence[int],
        motion: ExpectedMotion | None = None,
    ) -> None:
        self._legs, self._lessons, self._plan = Legs(route, scope, motion), lessons, plan
        self._times = LegTimes(self._legs, list(sequences))
        self._forecasts, self._pace = Forecasts(), OwnPace()
        self._seen_m = 0.0
        """Where the vehicle was last."""
        self._expected: Expectations | None = None
        self._renewed_ns = self._taught = 0
        """When that was reckoned, and how much had been taught by then."""

    def visits(self, outlook: Outlook, now_ns: int) -> list[Visit]:
        """The visits still to come; they are remembered until they have."""
        by = self._expectations(now_ns)
        gone_s = usual_s(by, outlook, self._seen_m)
        self._seen_m = outlook.total_m
        self._pace.see(gone_s, outlook.t_ns, drives=outlook.drives)
        stand, slower = self._stand(by, outlook), self._pace.slower
        outlook = outlook._replace(stand=stand, slower=slower if outlook.drives else 1.0)
        if self._legs.motion is not None:
            outlook = outlook._replace(gone_s=self._gone_s(by, outlook))
        visits = predict_visits(by, outlook, now_ns)
        if self._forecasts.is_due(now_ns):
            for visit in visits:
                width_ns = visit.early_width_ns, visit.late_width_ns
                forecast = Forecast(now_ns, visit.arrival_ns, *width_ns, visit.is_learned)
                self._forecasts.make(visit.stop, forecast)
        return visits

    def begins(self, comes: StopArrival, departs_ns: int, t_ns: int) -> Stand:
        """Until it leaves the first stop, of a vehicle that is still to come there from a trip.

        It leaves at its time, as late as others do, or when those have boarded who wait for it.
        """
        by = self._expectations(t_ns)
        comes_s = (comes.arrival_ns - t_ns) * 1e-9 + float(by.dwell_s[0])
        comes_std_s = (comes.late_ns - comes.early_ns) * 1e-9 / (2.0 * NORMAL_P90)
        leaves_s = (departs_ns - t_ns) * 1e-9 + float(by.late_s[0])
        mean_s, variance_s2, _ = later_of(
            (comes_s, comes_std_s**2 + float(by.dwell_s2[0])), (leaves_s, float(by.late_s2[0]))
        )
        wide_s = NORMAL_P90 * variance_s2**0.5
        return Stand(max(mean_s - wide_s, 0.0), mean_s, mean_s + wide_s)

    def observe(self, event: StopEvent) -> list[StopEvent | Learned]:
        """Take what the vehicle did at a stop: that, with its disruption, and what it taught."""
        driven = self._times.observe(event)
        if driven is None:
            return [event]
        learned = self._learned(driven)
        self._lessons.learn(learned)
        self._expected = None
        disruption = learned.taken.disruption or event.disruption
        return [msgspec.structs.replace(event, disruption=disruption), learned]

    def _expectations(self, t_ns: int) -> Expectations:
        age_ns, lessons = t_ns - self._renewed_ns, self._lessons
        due_ns = RENEWED_NS if lessons.taught != self._taught else FADED_NS
        if self._expected is None or age_ns >= due_ns:
            self._expected = expectations(lessons, self._legs, self._plan, t_ns)
            self._renewed_ns, self._taught = t_ns, lessons.taught
        return self._expected

    def _gone_s(self, by: Expectations, outlook: Outlook) -> float | None:
        """How long it has been under way to the next stop of a timetable, which plans no more."""
        stop = next_stop(by, outlook)
        return None if stop is None else self._times.gone_s(stop, outlook.t_ns)

    def _stand(self, by: Expectations, outlook: Outlook) -> Stand:
        """How long it will still stand: at a stop without a time as long as others have stood."""
        stands = self._times.stands(outlook.t_ns)
        if stands is None:
            return outlook.stand
        stop, stood_s = stands
        if np.isfinite(self._legs.leaves_ns[stop]):
            return self._wait(by, outlook, stop)
        if self._legs.motion is not None or by.dwells_seen[stop] < DWELLS_SEEN:
            return outlook.stand
        return rest_of_dwell(stood_s, float(by.dwell_s[stop]), float(by.dwell_s2[stop]))

    def _wait(self, by: Expectations, outlook: Outlook, stop: int) -> Stand:
        """How long it will still stand where it waits for its time: others leave late, too."""
        if outlook.stand.left_s <= 0.0:
            return outlook.stand
        waits_s = (float(self._legs.leaves_ns[stop]) - outlook.t_ns) * 1e-9
        if waits_s < 0.0:
            return outlook.stand
        std_s = float(by.late_s2[stop]) ** 0.5
        left_s = max(waits_s + float(by.late_s[stop]), outlook.stand.left_s)
        return Stand(max(left_s - std_s, 0.0), left_s, left_s + NORMAL_P90 * std_s)

    def _stood(self, driven: leg_times.Taken) -> tuple[str, float]:
        """What a stand tells of: how long a vehicle stands there, or how late one leaves.

        Who comes long before it may leave tells nothing of boarding.
        """
        key, leaves_ns = self._legs.keys[driven.stop], float(self._legs.leaves_ns[driven.stop])
        early_s = (leaves_ns - driven.arrived_ns) * 1e-9
        planned_s = float(self._legs.dwells_s[driven.stop])
        if early_s <= self._lessons.experience.dwell(key, self._plan, planned_s).seconds:
            return key, driven.dwell_s
        return self._legs.waits(driven.stop), driven.dwell_s - early_s

    def _disruption(self, driven: leg_times.Taken, stood: str, stood_s: float) -> Disruption | None:
        """A breakdown on the way to a stop or at it; both are asked of, for both count."""
        leg, is_one = driven.leg, self._lessons.breakdowns.is_one
        usual_s = self._usual_stand_s(stood, float(self._legs.dwells_s[driven.stop]))
        broken = [is_one(stood, stood_s, usual_s)]
        if leg is not None:
            usual = self._lessons.experience.travel(leg, self._plan, driven.arrived_ns)
            broken.append(is_one(leg.key, driven.travel_s, usual.seconds))
        return "breakdown" if any(broken) else None

    def _usual_stand_s(self, stood: str, planned_s: float) -> float:
        """How long vehicles stand at a stop, or how late they leave it."""
        experience = self._lessons.experience
        if is_wait(stood):
            return max(experience.late(stood).seconds, 0.0)
        usual_s = experience.dwell(stood, self._plan, planned_s).seconds
        is_known = experience.dwells_seen(stood) >= DWELLS_SEEN
        return usual_s if is_known else max(usual_s, UNKNOWN_STAND_S)

    def _learned(self, driven: leg_times.Taken) -> Learned:
        leg, stop = driven.leg, self._legs.keys[driven.stop]
        stood, stood_s = self._stood(driven)
        taken = Taken(
            t_ns=driven.arrived_ns,
            leg=None if leg is None else leg.key,
            plan=self._plan,
            planned_s=0.0 if leg is None else leg.planned_s,
            travel_s=driven.travel_s,
            stop=stood,
            dwell_s=stood_s,
            disruption=self._disruption(driven, stood, stood_s),
        )
        came = self._forecasts.arrive(driven.stop, driven.arrived_ns)
        return Learned(
            taken=taken,
            came=tuple(Came(each.made_ns, stop, self._plan, each.span, each.off) for each in came),
        )
