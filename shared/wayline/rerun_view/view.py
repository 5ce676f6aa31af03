"""One vehicle's messages as rows of Rerun entities, below the vehicle's id."""

import math
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import rerun as rr

from wayline.geo import step_between
from wayline.messages import (
    FusionStatus,
    GpsFix,
    GpsRaw,
    Horizon,
    Message,
    Odometer,
    Pose,
    Progress,
    Torque,
    Verdict,
)
from wayline.rerun_view.blueprint import NIS_TOP
from wayline.rerun_view.columns import Columns
from wayline.rerun_view.decimation import Decimator
from wayline.rerun_view.satellites import SatelliteView, is_of_satellite
from wayline.rerun_view.shapes import Extent, arrow_of, ellipse_of
from wayline.route import Route

PLOT_PERIOD_NS = 95_000_000
"""Plots get 10 Hz at most; a little less than 100 ms, for sensors whose clocks jitter."""
MAP_PERIOD_NS = 495_000_000
"""The vehicle moves on the map at 2 Hz: an ellipse has 33 vertices."""
PATH_STEP_M = 2.0
"""A piece of the path is at least this long: a vehicle that stands draws none."""
FIXES_KEPT = 64
"""Fixes whose verdict may still come, to be marked where it rejects them; over 3 s of 20 Hz."""
POSES_KEPT = 64
"""Poses to compare a rejected fix with, likewise; over 6 s of 10 Hz."""
SAME_TIME_NS = 100_000_000
"""A pose this far from a fix in time is where the vehicle was believed to be, to a metre or two."""
POSITIONS = ("gps_position", "kept_gps_position")
"""Sensors that are rejected for where they are."""
CROSS_NIS_MAX = 0.95 * NIS_TOP
"""Crosses of larger ones are drawn here, at the plot's upper edge."""
SILENT_AFTER_NS = 5_000_000_000
"""A sensor without a verdict for so long is shown as silent, not as still accepted."""
CALIBRATED = (
    ("gyro_bias_degps", "gyro_bias_std_degps"),
    ("gyro_scale", "gyro_scale_std"),
    ("odometer_scale", "odometer_scale_std"),
    ("baro_bias_m", "baro_bias_std_m"),
    ("torque_bias_pct", "torque_bias_std_pct"),
    ("mass_kg", "mass_std_kg"),
    ("gps_latency_s", "gps_latency_std_s"),
)
"""Parameters of fusion's status with their stds."""


class _Place(NamedTuple):
    t_ns: int
    lat_deg: float
    lon_deg: float


class RerunView:
    """Turns messages of one vehicle into rows; what Rerun has no place for is passed over.

    Rows wait for `batch_s` of measurement time: about a second where someone watches, a minute
    for a file. Routes, where given, are drawn once with their stops.
    """

    def __init__(
        self,
        vehicle_id: str,
        stream: rr.RecordingStream,
        *,
        routes: Sequence[Route] = (),
        batch_s: float = 1.0,
    ) -> None:
        self._columns = Columns(stream, vehicle_id, batch_s)
        self._plotted, self._mapped = Decimator(PLOT_PERIOD_NS), Decimator(MAP_PERIOD_NS)
        self._states: dict[str, str] = {}
        self._judged_ns: dict[str, int] = {}
        self._fixes: dict[int, tuple[float, float]] = {}
        self._poses: deque[_Place] = deque(maxlen=POSES_KEPT)
        self._path_from: Pose | None = None
        self._satellites = SatelliteView(self._columns)
        self.extent = Extent()
        if routes:
            self._log_routes(routes)

    @property
    def rows_sent(self) -> int:
        """Rows sent to Rerun so far."""
        return self._columns.rows_sent

    def log(self, message: Message, source: str) -> None:
        """Take a message from a source of the bus."""
        take = _TAKERS.get(type(message))
        if take is None:
            return
        self._columns.send_when_due(message.t_ns)
        take(self, message, source)

    def flush(self) -> None:
        """Send what waits for its batch to fill."""
        self._columns.send()

    def _log_routes(self, routes: Sequence[Route]) -> None:
        lines = [np.column_stack((each.line.lats_deg, each.line.lons_deg)) for each in routes]
        self._columns.static("map/route", rr.GeoLineStrings(lat_lon=lines))
        stops = [stop for route in routes for stop in route.stops]
        if stops:
            places = [(stop.lat_deg, stop.lon_deg) for stop in stops]
            names = [stop.name for stop in stops]
            self._columns.static(
                "map/stops", rr.GeoPoints(lat_lon=places), rr.AnyValues(stop_name=names)
            )

    def _take_fix(self, fix: GpsFix, source: str) -> None:
        self._state(f"states/fix/{source}", fix.t_ns, fix.fix if fix.valid else "none")
        self._scalar(f"speed/gps/{source}", fix.t_ns, fix.speed_mps)
        self._scalar(f"altitude/gps/{source}", fix.t_ns, fix.alt_m)
        if not fix.valid or fix.lat_deg is None or fix.lon_deg is None:
            return
        self._columns.point("map/fixes", fix.t_ns, fix.lat_deg, fix.lon_deg)
        self._fixes[fix.t_ns] = fix.lat_deg, fix.lon_deg
        if len(self._fixes) > FIXES_KEPT:
            del self._fixes[next(iter(self._fixes))]

    def _take_raw(self, epoch: GpsRaw, source: str) -> None:
        del source
        place = self._poses[-1] if self._poses else None
        self._satellites.hear(epoch, place and (place.lat_deg, place.lon_deg))

    def _take_odometer(self, odometer: Odometer, source: str) -> None:
        if self._plotted.is_due(f"odometer/{source}", odometer.t_ns):
            self._scalar(f"speed/odometer/{source}", odometer.t_ns, odometer.speed_mps)

    def _take_torque(self, torque: Torque, source: str) -> None:
        if torque.slope_pct is not None and self._plotted.is_due(f"torque/{source}", torque.t_ns):
            self._scalar(f"grade/vehicle/{source}", torque.t_ns, torque.slope_pct)

    def _take_pose(self, pose: Pose, source: str) -> None:
        self._state("states/mode", pose.t_ns, pose.mode)
        if pose.lat_deg is not None and pose.lon_deg is not None:
            self._poses.append(_Place(pose.t_ns, pose.lat_deg, pose.lon_deg))
        if self._plotted.is_due(f"pose/{source}", pose.t_ns):
            self._scalar("speed/fused", pose.t_ns, pose.speed_mps)
            self._estimate("altitude/fused", pose.t_ns, pose.alt_m, pose.alt_std_m)
            self._estimate("grade/fused", pose.t_ns, pose.grade_pct, pose.grade_std_pct)
        if self._mapped.is_due(f"pose/{source}", pose.t_ns):
            self._map_pose(pose)

    def _map_pose(self, pose: Pose) -> None:
        if pose.lat_deg is None or pose.lon_deg is None:
            self._path_from = None
            return
        self.extent.add(pose.lat_deg, pose.lon_deg)
        self._columns.point("map/vehicle", pose.t_ns, pose.lat_deg, pose.lon_deg)
        for path, line in (("map/heading", arrow_of(pose)), ("map/ellipse_95", ellipse_of(pose))):
            if line is not None:
                self._columns.line(path, pose.t_ns, line)
        self._extend_path(pose)

    def _extend_path(self, pose: Pose) -> None:
        """Add the piece since the last one; `distance_m` falls only where a drive starts again."""
        start = self._path_from
        if start is not None and 0.0 <= pose.distance_m - start.distance_m < PATH_STEP_M:
            return
        if start is not None and pose.distance_m >= start.distance_m:
            piece = [(start.lat_deg, start.lon_deg), (pose.lat_deg, pose.lon_deg)]
            self._columns.line("map/path", pose.t_ns, np.array(piece, dtype=np.float64))
        self._path_from = pose

    def _take_status(self, status: FusionStatus, source: str) -> None:
        del source
        self._state("states/calibration", status.t_ns, status.calibration)
        for name, std_name in CALIBRATED:
            value, std = getattr(status, name), getattr(status, std_name)
            self._estimate(f"calibration/{name}", status.t_ns, value, std)
        for slope in status.slopes:
            entity = f"grade/{slope.sensor}" + (f"/{slope.source}" if slope.source else "")
            self._scalar(entity, status.t_ns, slope.slope_pct)
        self._satellites.judge(each for each in status.verdicts if is_of_satellite(each))
        for verdict in status.verdicts:
            if not is_of_satellite(verdict):
                self._take_verdict(verdict)
        for sensor, t_ns in self._judged_ns.items():
            if status.t_ns - t_ns > SILENT_AFTER_NS:
                self._state(f"states/verdict/{sensor}", status.t_ns, "silent")

    def _take_verdict(self, verdict: Verdict) -> None:
        root = f"innovations/{verdict.sensor}"
        # what was refused before it reached the gate has no threshold
        if verdict.threshold > 0.0:
            self._columns.scalars(f"{root}/nis", verdict.t_ns, verdict.nis)
            self._columns.scalars(f"{root}/gate", verdict.t_ns, verdict.threshold)
        off_m = None if verdict.accepted else self._mark_rejected(verdict)
        if verdict.reason:
            self._columns.text(f"reasons/{verdict.sensor}", verdict.t_ns, reason_of(verdict, off_m))
        self._judged_ns[verdict.sensor] = verdict.t_ns
        word = "accepted" if verdict.accepted else "rejected"
        self._state(f"states/verdict/{verdict.sensor}", verdict.t_ns, word)

    def _mark_rejected(self, verdict: Verdict) -> float | None:
        """Mark it in its plot and on the map; how far a position is from where the pose was."""
        if verdict.threshold > 0.0:
            path = f"innovations/{verdict.sensor}/rejected"
            self._columns.scalars(path, verdict.t_ns, min(verdict.nis, CROSS_NIS_MAX))
        fix = self._fixes.get(verdict.t_ns)
        if fix is None:
            return None
        self._columns.point("map/rejected", verdict.t_ns, *fix)
        pose = self._pose_at(verdict.t_ns)
        if pose is None or verdict.sensor not in POSITIONS:
            return None
        line = np.array([(pose.lat_deg, pose.lon_deg), fix], dtype=np.float64)
        self._columns.line("map/rejected_from", verdict.t_ns, line)
        return step_between(pose.lat_deg, pose.lon_deg, *fix).distance_m

    def _pose_at(self, t_ns: int) -> _Place | None:
        """Where the vehicle was believed to be before a fix of this time was heard."""
        nearest = min(self._poses, key=lambda pose: abs(pose.t_ns - t_ns), default=None)
        if nearest is None or abs(nearest.t_ns - t_ns) > SAME_TIME_NS:
            return None
        return nearest

    def _take_progress(self, progress: Progress, source: str) -> None:
        del source
        on_route = "on route" if progress.on_route else "off route"
        self._state("states/route", progress.t_ns, on_route)
        self._columns.point("map/on_route", progress.t_ns, progress.lat_deg, progress.lon_deg)

    def _take_horizon(self, horizon: Horizon, source: str) -> None:
        del source
        if horizon.points:
            self._scalar("grade/earlier_runs", horizon.t_ns, horizon.points[0].grade_pct)

    def _scalar(self, path: str, t_ns: int, value: float | None) -> None:
        if value is not None:
            self._columns.scalars(path, t_ns, value)

    def _estimate(self, path: str, t_ns: int, value: float | None, std: float | None) -> None:
        """A value between its one-sigma bounds; they are left open where the std is unknown."""
        if value is None:
            return
        sigma = math.nan if std is None else std
        self._columns.scalars(path, t_ns, value, value + sigma, value - sigma)

    def _state(self, path: str, t_ns: int, state: str) -> None:
        """A state is a row only where it changes."""
        if self._states.get(path) != state:
            self._states[path] = state
            self._columns.state(path, t_ns, state)


def reason_of(verdict: Verdict, off_m: float | None = None) -> str:
    """Why a measurement was rejected, or what is to be known of an accepted one, in a line."""
    word = "accepted" if verdict.accepted else "rejected"
    off = "" if off_m is None else f", {off_m:.0f} m off"
    figures = f" (NIS {verdict.nis:.1f}, gate {verdict.threshold:.1f})" if verdict.threshold else ""
    return f"{verdict.sensor} {word}{off}{figures}: {verdict.reason}"


_TAKERS: dict[type[Message], Callable[[RerunView, Any, str], None]] = {
    GpsFix: RerunView._take_fix,
    GpsRaw: RerunView._take_raw,
    Odometer: RerunView._take_odometer,
    Torque: RerunView._take_torque,
    Pose: RerunView._take_pose,
    FusionStatus: RerunView._take_status,
    Progress: RerunView._take_progress,
    Horizon: RerunView._take_horizon,
}
READS: frozenset[type[Message]] = frozenset(_TAKERS)
"""The topics that a view shows; the rest need not be read for it."""
