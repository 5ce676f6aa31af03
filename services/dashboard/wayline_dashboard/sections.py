"""Pure: each bus message as the section of the view that it fills."""

from wayline.messages import (
    Arrivals,
    FusionStatus,
    GpsFix,
    Health,
    Horizon,
    Pose,
    Progress,
    SensorSlope,
    StopArrival,
)
from wayline.rfc3339 import rfc3339
from wayline_dashboard.ellipse import ellipse_of
from wayline_dashboard.view import (
    ArrivalsView,
    FixView,
    HorizonView,
    MissingView,
    PoseView,
    ProgressView,
    SensorSlopeView,
    ServiceView,
    SlopePoint,
    StatusView,
    StopView,
)


def pose_view(pose: Pose) -> PoseView:
    """A pose with its covariance as an ellipse."""
    return PoseView(
        t=rfc3339(pose.t_ns),
        mode=pose.mode,
        lat_deg=pose.lat_deg,
        lon_deg=pose.lon_deg,
        alt_m=pose.alt_m,
        alt_std_m=pose.alt_std_m,
        heading_deg=pose.heading_deg,
        heading_std_deg=pose.heading_std_deg,
        speed_mps=pose.speed_mps,
        speed_std_mps=pose.speed_std_mps,
        grade_pct=pose.grade_pct,
        grade_std_pct=pose.grade_std_pct,
        distance_m=pose.distance_m,
        ellipse=ellipse_of(pose),
    )


def fix_view(fix: GpsFix, source: str) -> FixView:
    """A raw fix and the receiver's service it came from."""
    return FixView(
        t=rfc3339(fix.t_ns),
        source=source,
        valid=fix.valid,
        fix=fix.fix,
        lat_deg=fix.lat_deg,
        lon_deg=fix.lon_deg,
        satellites=fix.satellites,
        hdop=fix.hdop,
        h_std_m=fix.h_std_m,
    )


def status_view(status: FusionStatus, last_rejection: str | None) -> StatusView:
    """Fusion's status; verdicts come only once each, so the last rejection is carried on."""
    return StatusView(
        t=rfc3339(status.t_ns),
        calibration=status.calibration,
        outage_s=status.outage_s,
        late=status.late,
        rejected=status.rejected,
        last_rejection=newest_rejection(status) or last_rejection,
        slopes=tuple(_slope_view(slope, status) for slope in status.slopes),
    )


def _slope_view(slope: SensorSlope, status: FusionStatus) -> SensorSlopeView:
    return SensorSlopeView(
        sensor=slope.sensor,
        source=slope.source,
        slope_pct=slope.slope_pct,
        slope_std_pct=slope.slope_std_pct,
        refused=any(
            verdict.sensor == slope.sensor and not verdict.accepted for verdict in status.verdicts
        ),
    )


def newest_rejection(status: FusionStatus) -> str | None:
    """Sensor and reason of the newest measurement that a gate refused, None where none was."""
    refused = [verdict for verdict in status.verdicts if not verdict.accepted]
    if not refused:
        return None
    newest = max(refused, key=lambda verdict: verdict.t_ns)
    return f"{newest.sensor}: {newest.reason}" if newest.reason else newest.sensor


def progress_view(progress: Progress) -> ProgressView:
    """Progress along the route; its point on the route is the page's to draw from distance."""
    return ProgressView(
        t=rfc3339(progress.t_ns),
        route_id=progress.route_id,
        trip_id=progress.trip_id,
        distance_m=progress.distance_m,
        distance_std_m=progress.distance_std_m,
        lap=progress.lap,
        cross_track_m=progress.cross_track_m,
        on_route=progress.on_route,
        delay_s=progress.delay_s,
    )


def arrivals_view(arrivals: Arrivals) -> ArrivalsView:
    """The next arrival at each stop, soonest first."""
    return ArrivalsView(
        t=rfc3339(arrivals.t_ns),
        route_id=arrivals.route_id,
        trip_id=arrivals.trip_id,
        headsign=arrivals.headsign,
        stale=arrivals.stale,
        stops=tuple(map(_stop_view, sorted(arrivals.stops, key=lambda stop: stop.arrival_ns))),
    )


def _stop_view(stop: StopArrival) -> StopView:
    scheduled_ns = stop.scheduled_ns
    delay_s = None if scheduled_ns is None else (stop.arrival_ns - scheduled_ns) * 1e-9
    return StopView(
        stop_id=stop.stop_id,
        name=stop.name,
        distance_m=stop.distance_m,
        arrival=rfc3339(stop.arrival_ns),
        early=rfc3339(stop.early_ns),
        late=rfc3339(stop.late_ns),
        scheduled=None if scheduled_ns is None else rfc3339(scheduled_ns),
        delay_s=delay_s,
        trip_id=stop.trip_id,
    )


def horizon_view(horizon: Horizon) -> HorizonView:
    """The slope ahead without each point's time."""
    points = tuple(
        SlopePoint(
            distance_m=point.distance_m,
            grade_pct=point.grade_pct,
            grade_std_pct=point.grade_std_pct,
            alt_m=point.alt_m,
            runs=point.runs,
        )
        for point in horizon.points
    )
    return HorizonView(t=rfc3339(horizon.t_ns), road_id=horizon.road_id, points=points)


def service_view(service: str, up: bool, health: Health | None) -> ServiceView:
    """A service by its liveliness and its last health, where there was one."""
    if health is None:
        return ServiceView(service=service, up=up)
    return ServiceView(
        service=service,
        up=up,
        t=rfc3339(health.t_ns),
        version=health.version,
        in_rate_hz=health.in_rate_hz,
        out_rate_hz=health.out_rate_hz,
        backlog=health.backlog,
        dropped=health.dropped,
        dropped_rate_hz=health.dropped_rate_hz,
        bad_input=health.bad_input,
        bad_input_rate_hz=health.bad_input_rate_hz,
        lag_ms_p50=health.lag_ms_p50,
        lag_ms_p99=health.lag_ms_p99,
        detail=health.detail,
        missing=tuple(
            MissingView(subject=each.subject, what=each.what, since=rfc3339(each.since_ns))
            for each in health.missing
        ),
        recorded=health.recorded,
    )
