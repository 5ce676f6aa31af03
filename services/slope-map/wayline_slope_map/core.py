"""Pure: one vehicle's slope map: collects its run, hands it over when it ends, looks ahead."""

from collections.abc import Sequence
from typing import ClassVar

import msgspec

from wayline.core import Record, Sleep
from wayline.drive import Vehicle
from wayline.geo import step_between, wrap_360
from wayline.inputs import Flush, Tick
from wayline.matching.matcher import Matcher
from wayline.matching.transition import Moves
from wayline.messages import Barometer, GpsFix, Horizon, Message, Odometer, Pose, Progress, Torque
from wayline.tuning import Tuning
from wayline_slope_map.accounting import leapt, told, whole
from wayline_slope_map.altimeters import Altimeters
from wayline_slope_map.known_roads import KnownRoads, RoadsOfVehicle
from wayline_slope_map.left_out import UNPLACED
from wayline_slope_map.matching import CHANGE_COST, SPACING_M, Match, carried_on
from wayline_slope_map.profile import lookahead
from wayline_slope_map.records import DrivenRun, RoadLearned
from wayline_slope_map.run import driven_run
from wayline_slope_map.track import Place, Track
from wayline_slope_map.turning import Turning

CAR = Vehicle()
"""Where nobody has said what the vehicle is."""
SECOND_NS = 1_000_000_000
PLACED_MODES = ("gps", "fused", "dead_reckoning")
PARKED_WITHIN_M = 30.0
"""The travelled distance of a vehicle that stands creeps by noise."""
FRESH_NS = 2 * SECOND_NS
"""An older pose says where the vehicle was, not where it is."""
LEAP_M, LEAP_STDS = 30.0, 3.0
"""A position that is farther from the last than was travelled by more, and by more of its stds, was
not driven to: a ferry, or a receiver that lied."""
LOST_AFTER_M = 150.0
"""Travelled without a place on its road, the vehicle may have left it."""


class SlopeMapCore:
    """Reads poses and the altimeters of one vehicle; gives `horizon` and finished runs.

    `roads` are those known so far; `RoadLearned` inputs bring them up to date. Of several routes
    the vehicle's is the one assigned to it, else the one that `progress` tells.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset(
        {Pose, GpsFix, Barometer, Torque, Odometer, Progress}
    )
    period_ns: ClassVar[int | None] = SECOND_NS

    def __init__(
        self,
        roads: KnownRoads,
        tuning: Tuning,
        vehicle_id: str,
        vehicle: Vehicle = CAR,
        route_id: str | None = None,
    ) -> None:
        self._roads, self._tuning, self._vehicle_id = roads, tuning, vehicle_id
        self._altimeters = Altimeters(vehicle, tuning)
        self._turning = Turning()
        self._track = Track()
        self._network = RoadsOfVehicle(roads, route_id)
        self._matcher = Matcher(self._network, jump_cost=CHANGE_COST)
        self._pose: Pose | None = None
        self._driving: Pose | None = None
        """The last pose that was well ahead of the one kept here before."""
        self._is_looking = False
        """The last horizon told what lies ahead of a fresh pose."""

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record | Sleep]:
        """Take one input and return what follows from it, in order."""
        match message:
            case Pose():
                return self._take_pose(message)
            case Progress():
                self._network.follow(message.route_id if message.on_route else None)
            case Tick() if message.t_ns % SECOND_NS == 0:
                return self._look_ahead(message)
            case Flush():
                return self._finish()
            case RoadLearned():
                self._roads.learn(message.profile)
            case _:
                self._altimeters.take(message, source, self._track, self._driven_m)
        return []

    @property
    def _driven_m(self) -> float:
        return 0.0 if self._pose is None else self._pose.distance_m

    def _take_pose(self, pose: Pose) -> Sequence[Record]:
        last = self._pose
        if last is not None and pose.t_ns < last.t_ns:
            return []
        turned_m = self._turning.turned_m(pose)
        if turned_m is not None:
            self._track.end_at(turned_m)
        ended = turned_m is not None or (
            last is not None and (self._ends_run(last, pose) or self._is_parked(pose))
        )
        finished: Sequence[Record] = []
        if ended:
            finished = self._finish()
            self._matcher.forget()
        self._pose = pose
        place = self._place(pose)
        if place is not None and self._has_leapt(place):
            finished = self._leap_to(place)
        elif place is not None and self._is_new_lap(place):
            finished = self._finish()
        self._track.travel(pose.t_ns, pose.distance_m)
        unplaced = None if self._is_placed(pose) else UNPLACED
        self._track.left_out.note("position", unplaced, pose.t_ns, pose.distance_m, None)
        if place is not None:
            self._track.places.append(place)
        return finished

    def _ends_run(self, last: Pose, pose: Pose) -> bool:
        """After a silence, after a restart of fusion, or because the run has grown long."""
        silent = pose.t_ns - last.t_ns > self._tuning.map_gap_s * SECOND_NS
        restarted = pose.distance_m < last.distance_m
        start_m = self._track.travelled_m[0] if self._track.travelled_m else pose.distance_m
        long = pose.distance_m - start_m > self._tuning.map_run_max_m
        return silent or restarted or long

    def _is_parked(self, pose: Pose) -> bool:
        """Whether the vehicle has now stood for long; poses go on meanwhile."""
        driving = self._driving
        if driving is None or abs(pose.distance_m - driving.distance_m) > PARKED_WITHIN_M:
            self._driving = driving = pose
        parked = pose.t_ns - driving.t_ns > self._tuning.map_park_s * SECOND_NS
        if parked:
            self._driving = pose
        return parked

    def _place(self, pose: Pose) -> Place | None:
        """The pose as a place of the run, every 10 m and where it is known well enough."""
        last = self._last_place()
        moved_m = pose.distance_m - last.travelled_m if last else 0.0
        if last is not None and moved_m < SPACING_M:
            return None
        if pose.lat_deg is None or pose.lon_deg is None or pose.heading_deg is None:
            return None
        if not self._is_placed(pose):
            return None
        # a vehicle in reverse travels the road the other way
        reverse = pose.speed_mps is not None and pose.speed_mps < 0.0
        course_deg = wrap_360(pose.heading_deg + 180.0) if reverse else pose.heading_deg
        place = Place(
            pose.t_ns,
            pose.distance_m,
            pose.lat_deg,
            pose.lon_deg,
            course_deg,
            None,
            _position_std_m(pose),
            is_reckoned=pose.mode == "dead_reckoning",
        )
        found = self._matcher.observe(place.sight, Moves.measured(moved_m))
        return place._replace(match=Match.of(found.candidate)) if found else place

    def _is_placed(self, pose: Pose) -> bool:
        """Whether it is known well enough where the vehicle is."""
        is_told = pose.mode in PLACED_MODES and pose.lat_deg is not None
        return is_told and _position_std_m(pose) <= self._tuning.map_position_std_max_m

    def _last_place(self) -> Place | None:
        return self._track.places[-1] if self._track.places else None

    def _is_new_lap(self, place: Place) -> bool:
        """Back by more than half of a road: its next lap, or its next run, has begun."""
        last = self._last_place()
        if last is None or last.match is None or place.match is None:
            return False
        if last.match[:2] != place.match[:2]:
            return False
        length_m = self._roads.profile(place.match.road_id).road.line.length_m
        back_m = (last.match.along_m - place.match.along_m) * place.match.direction
        return back_m > 0.5 * length_m

    def _has_leapt(self, place: Place) -> bool:
        """Farther away than the wheels have turned: no road was driven in between."""
        last = self._last_place()
        if last is None:
            return False
        apart = step_between(last.lat_deg, last.lon_deg, place.lat_deg, place.lon_deg)
        allowed_m = max(LEAP_M, LEAP_STDS * max(last.std_m, place.std_m))
        return apart.distance_m - (place.travelled_m - last.travelled_m) > allowed_m

    def _leap_to(self, place: Place) -> Sequence[Record]:
        """The run ends where the position leaps to another place.

        What was reckoned before, without a fix that was believed, led astray.
        """
        places = self._track.places
        sure = next((each for each in reversed(places) if not each.is_reckoned), places[0])
        self._track.doubted_from_m = sure.travelled_m
        return [*self._finish(), leapt(self._vehicle_id, sure, place)]

    def _finish(self) -> Sequence[Record]:
        """The run of the track so far, and what of it is left out; a new track begins."""
        track, self._track = self._track, Track()
        spans = list(track.left_out.take())
        run = driven_run(track, self._vehicle_id, self._roads.roads(), self._tuning)
        if isinstance(run, DrivenRun):
            return [run, *told(self._vehicle_id, track, spans)]
        is_said = any(span.sensor is None for span in spans)
        return told(self._vehicle_id, track, spans if is_said else [*spans, *whole(track, run)])

    def _look_ahead(self, tick: Tick) -> Sequence[Message | Sleep]:
        """The horizon of a fresh pose; without one it ends with an empty one."""
        if self._pose is not None and tick.t_ns - self._pose.t_ns + tick.age_ns <= FRESH_NS:
            self._is_looking = True
            return [self._horizon(tick.t_ns, self._pose)]
        ended = [Horizon(t_ns=tick.t_ns)] if self._is_looking else []
        self._is_looking = False
        return [*ended, Sleep()]

    def _horizon(self, t_ns: int, pose: Pose) -> Horizon:
        here = self._here(pose)
        if here is None:
            return Horizon(t_ns=t_ns)
        profile = self._roads.profile(here.road_id)
        points = lookahead(
            profile,
            here.along_m,
            here.direction,
            length_m=self._tuning.horizon_length_m,
            step_m=self._tuning.horizon_step_m,
        )
        return Horizon(
            t_ns=t_ns,
            road_id=here.road_id,
            direction=1 if here.direction > 0 else -1,
            position_m=here.along_m,
            points=points,
        )

    def _here(self, pose: Pose) -> Match | None:
        """The place on a road, the last one carried on by the distance travelled since."""
        last = self._last_place()
        if last is None or last.match is None:
            return None
        moved_m = pose.distance_m - last.travelled_m
        if moved_m > LOST_AFTER_M:
            return None
        return carried_on(self._roads.profile(last.match.road_id).road, last.match, moved_m)


def _position_std_m(pose: Pose) -> float:
    """One sigma of the worse axis."""
    return max(pose.east_std_m or 0.0, pose.north_std_m or 0.0)
