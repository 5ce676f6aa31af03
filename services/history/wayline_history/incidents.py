"""Pure: what happens to a vehicle, read from what its services say of it.

What one topic tells does not depend on when another's message came: on the bus they overtake each
other, and a drive that is replayed has to tell the same.
"""

from wayline.messages import FusionStatus, Pose, PoseMode, Progress, StopEvent, Verdict
from wayline_history.records import Event
from wayline_history.spans import Place, Spans

WITHOUT_FIXES: frozenset[PoseMode] = frozenset({"dead_reckoning", "lost"})


class Incidents:
    """Modes, outages, refusals, leaving the route, and stops of one vehicle."""

    def __init__(self) -> None:
        self.spans = Spans()
        self._mode: PoseMode | None = None

    def pose(self, pose: Pose) -> None:
        """A pose, where its mode is another one than the last's."""
        mode, self._mode = self._mode, pose.mode
        if mode == pose.mode:
            return
        place = Place(pose.lat_deg, pose.lon_deg)
        self.spans.tell(
            Event(
                t_ns=pose.t_ns,
                kind="mode",
                name=pose.mode,
                lat_deg=place.lat_deg,
                lon_deg=place.lon_deg,
                detail=None if mode is None else f"after {mode}",
            )
        )
        if pose.mode in WITHOUT_FIXES:
            self.spans.begin("outage", "", pose.t_ns, place)
        else:
            self.spans.end("outage", "", pose.t_ns)

    def status(self, status: FusionStatus) -> list[Verdict]:
        """What fusion did with measurements; the verdicts that refused one."""
        refused = [verdict for verdict in status.verdicts if not verdict.accepted]
        for verdict in refused:
            name = f"{verdict.sensor}: {verdict.reason}" if verdict.reason else verdict.sensor
            self.spans.count("rejected", name, verdict.t_ns)
        return refused

    def progress(self, progress: Progress) -> None:
        """A place along the route, or off it."""
        if progress.on_route:
            self.spans.end_all("off_route", progress.t_ns)
        else:
            place = Place(progress.lat_deg, progress.lon_deg)
            self.spans.begin("off_route", progress.route_id, progress.t_ns, place)

    def stop(self, stop: StopEvent) -> None:
        """A stop was reached, left, passed or left out."""
        trip = f", trip {stop.trip_id}" if stop.trip_id else ""
        disruption = f", {stop.disruption}" if stop.disruption else ""
        self.spans.tell(
            Event(
                t_ns=stop.t_ns,
                kind="stop",
                name=f"{stop.kind} {stop.stop_id}",
                detail=f"route {stop.route_id}{trip}{disruption}",
            )
        )
