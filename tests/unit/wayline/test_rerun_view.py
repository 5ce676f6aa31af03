"""What a vehicle's messages become in Rerun: entities, rows and shapes, read back from the file."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from rerun.chunk import RrdReader

from builders import START_NS, about, at, fix, gyro, odometer
from wayline.errors import InputError
from wayline.geo import step_between
from wayline.messages import (
    FusionStatus,
    GpsRaw,
    Horizon,
    HorizonPoint,
    Message,
    Pose,
    Progress,
    RawSatellite,
    SensorSlope,
    Verdict,
)
from wayline.rerun_view import READS, RerunRecording
from wayline.rerun_view.blueprint import GPS, HORIZONTAL, NIS_TOP, VERTICAL, make_blueprint
from wayline.rerun_view.decimation import Decimator
from wayline.rerun_view.shapes import (
    NEAR_ZOOM,
    Extent,
    arrow_of,
    ellipse_of,
)
from wayline.rerun_view.view import CALIBRATED
from wayline.route import Route, make_route
from wayline.stops import StopPlace

Rows = dict[str, list[tuple[int, Any]]]
"""By entity: its rows as (t_ns, value of the entity's one component), in order of time."""
Record = Callable[..., Rows]

LAT_DEG, LON_DEG = 55.87, 9.86


def pose(seconds: float, **fields: Any) -> Pose:
    known: dict[str, Any] = {"mode": "fused", "lat_deg": LAT_DEG, "lon_deg": LON_DEG, **fields}
    return Pose(t_ns=at(seconds), **known)


def judged(seconds: float, *, accepted: bool, nis: float = 1.0) -> FusionStatus:
    verdict = Verdict(
        sensor="gps_position", t_ns=at(seconds), accepted=accepted, nis=nis, threshold=18.4
    )
    return FusionStatus(t_ns=at(seconds), verdicts=(verdict,))


def route() -> Route:
    return make_route(
        "test",
        route_id="r",
        name="R",
        loop=False,
        vertices=[(LAT_DEG, LON_DEG), (LAT_DEG + 0.01, LON_DEG)],
        speeds_mps=None,
        stops=[StopPlace("a", "Alpha", LAT_DEG, LON_DEG), StopPlace("b", "B", 55.88, LON_DEG)],
    )


def read_back(path: Path) -> Rows:
    """The rows of a recording that lie on a timeline, without what is static."""
    rows: Rows = {}
    for chunk in RrdReader(path).stream().to_chunks():
        batch = chunk.to_record_batch()
        if chunk.is_static or not chunk.timeline_names:
            continue
        assert chunk.timeline_names == ["measurement_time"]
        times_ns = batch.column("measurement_time").cast("int64").to_pylist()
        (name,) = set(batch.schema.names) - {"rerun.controls.RowId", "measurement_time"}
        pairs = zip(times_ns, batch.column(name).to_pylist(), strict=True)
        rows.setdefault(chunk.entity_path, []).extend(pairs)
    return {entity: sorted(pairs, key=lambda pair: pair[0]) for entity, pairs in rows.items()}


def static_entities(path: Path) -> set[str]:
    chunks = RrdReader(path).stream().to_chunks()
    return {chunk.entity_path for chunk in chunks if chunk.is_static}


@pytest.fixture
def record(tmp_path: Path) -> Record:
    """Messages through a recording to a file and back."""

    def run(messages: Iterable[Message], **options: Any) -> Rows:
        path = tmp_path / "test.rrd"
        with RerunRecording(save=path, **options) as recording:
            for message in messages:
                recording.log("bus-7", message, "s")
        return read_back(path)

    return run


def test_a_fix_is_a_point_on_the_map_and_its_speed_and_altitude_are_plotted(
    record: Record,
) -> None:
    rows = record([fix(1.25, LAT_DEG, LON_DEG, speed_mps=3.5, alt_m=80.0)])
    assert rows["/bus-7/map/fixes"] == [(at(1.25), [[LAT_DEG, LON_DEG]])]
    assert rows["/bus-7/speed/gps/s"] == [(at(1.25), [3.5])]
    assert rows["/bus-7/altitude/gps/s"] == [(at(1.25), [80.0])]


def test_an_invalid_fix_is_no_point_but_a_state(record: Record) -> None:
    rows = record([fix(1, LAT_DEG, LON_DEG), fix(2, LAT_DEG, LON_DEG, valid=False)])
    assert [t_ns for t_ns, _ in rows["/bus-7/map/fixes"]] == [at(1)]
    assert rows["/bus-7/states/fix/s"] == [(at(1), ["gps"]), (at(2), ["none"])]


def test_a_rejected_fix_is_marked_where_it_was(record: Record) -> None:
    rows = record(
        [
            fix(1, LAT_DEG, LON_DEG),
            judged(1, accepted=True),
            fix(2, LAT_DEG + 1.0, LON_DEG),
            judged(2, accepted=False, nis=19.0),
        ]
    )
    assert rows["/bus-7/map/rejected"] == [(at(2), [[LAT_DEG + 1.0, LON_DEG]])]
    assert rows["/bus-7/innovations/gps_position/nis"] == [(at(1), [1.0]), (at(2), [19.0])]
    assert rows["/bus-7/innovations/gps_position/gate"] == [(at(1), [18.4]), (at(2), [18.4])]
    assert rows["/bus-7/innovations/gps_position/rejected"] == [(at(2), [19.0])]
    states = rows["/bus-7/states/verdict/gps_position"]
    assert states == [(at(1), ["accepted"]), (at(2), ["rejected"])]


def test_the_cross_of_a_nis_beyond_the_plot_is_drawn_at_its_upper_edge(record: Record) -> None:
    rows = record([judged(1, accepted=False, nis=1500.0)])
    ((_, [cross]),) = rows["/bus-7/innovations/gps_position/rejected"]
    assert 18.4 < cross < NIS_TOP
    assert rows["/bus-7/innovations/gps_position/nis"] == [(at(1), [1500.0])]


def test_a_rejected_position_is_tied_to_where_the_vehicle_was_believed_to_be(
    record: Record,
) -> None:
    """By a line on the map, and in metres in the log; the pose is the one of the fix's time."""
    poses = [pose(seconds, lat_deg=LAT_DEG + 1e-3 * seconds) for seconds in (1.0, 1.9, 2.0, 2.5)]
    far = Verdict(
        sensor="gps_position", t_ns=at(2), accepted=False, nis=99.0, threshold=18.4, reason="far"
    )
    north_deg = LAT_DEG + 3e-3
    status = FusionStatus(t_ns=at(3), verdicts=(far,))
    rows = record([*poses, fix(2, north_deg, LON_DEG), status])
    line = [[LAT_DEG + 2e-3, LON_DEG], [north_deg, LON_DEG]]
    assert rows["/bus-7/map/rejected_from"] == [(at(2), [line])]
    ((_, [text]),) = rows["/bus-7/reasons/gps_position"]
    assert text == "gps_position rejected, 111 m off (NIS 99.0, gate 18.4): far"


def test_nothing_is_tied_to_a_pose_of_another_time_nor_for_a_speed(record: Record) -> None:
    far = judged(2, accepted=False, nis=99.0)
    slow = msgspec.structs.replace(far.verdicts[0], sensor="gps_speed")
    old = [pose(1), fix(2, LAT_DEG, LON_DEG), far]
    now = [pose(2), fix(2, LAT_DEG, LON_DEG), FusionStatus(t_ns=at(2), verdicts=(slow,))]
    for messages in (old, now):
        rows = record(messages)
        assert "/bus-7/map/rejected_from" not in rows
        assert [t_ns for t_ns, _ in rows["/bus-7/map/rejected"]] == [at(2)]


def test_every_rejection_says_why(record: Record) -> None:
    """In words, with what was compared; of a reading refused before its gate only in words."""
    far = Verdict(
        sensor="gps_position", t_ns=at(1), accepted=False, nis=99.0, threshold=18.4, reason="far"
    )
    frozen = msgspec.structs.replace(far, t_ns=at(2), nis=0.0, threshold=0.0, reason="frozen")
    rows = record(
        [
            fix(2, LAT_DEG, LON_DEG),
            judged(0, accepted=True),
            FusionStatus(t_ns=at(2), verdicts=(far, frozen)),
        ]
    )
    assert rows["/bus-7/reasons/gps_position"] == [
        (at(1), ["gps_position rejected (NIS 99.0, gate 18.4): far"]),
        (at(2), ["gps_position rejected: frozen"]),
    ]
    assert [t_ns for t_ns, _ in rows["/bus-7/innovations/gps_position/nis"]] == [at(0), at(1)]
    assert [t_ns for t_ns, _ in rows["/bus-7/map/rejected"]] == [at(2)]


def test_a_sensor_without_verdicts_falls_silent(record: Record) -> None:
    later = [FusionStatus(t_ns=at(seconds)) for seconds in (3.0, 6.0, 6.5, 7.0)]
    rows = record([judged(1, accepted=True), *later])
    states = rows["/bus-7/states/verdict/gps_position"]
    assert states == [(at(1), ["accepted"]), (at(6.5), ["silent"])]


def test_satellites_stand_in_the_sky_green_or_red(tmp_path: Path) -> None:
    """East is right, the zenith in the middle; each range is off by the root of its NIS."""
    satellites = (
        RawSatellite(system="gps", prn=12, azimuth_deg=90.0, elevation_deg=60.0),
        RawSatellite(system="glonass", prn=3, azimuth_deg=180.0, elevation_deg=30.0),
    )
    verdicts = (
        Verdict(sensor="gps_raw G12", t_ns=at(1), accepted=True, nis=4.0, threshold=15.0),
        Verdict(sensor="gps_raw R3", t_ns=at(1), accepted=False, nis=49.0, threshold=15.0),
    )
    path = tmp_path / "sky.rrd"
    with RerunRecording(save=path) as recording:
        recording.log("bus-7", GpsRaw(t_ns=at(1), satellites=satellites), "s")
        recording.log("bus-7", FusionStatus(t_ns=at(1), verdicts=verdicts), "s")
    rows = {
        (chunk.entity_path, name.partition(":")[2]): chunk.to_record_batch()
        .column(name)
        .to_pylist()
        for chunk in RrdReader(path).stream().to_chunks()
        if not chunk.is_static
        for name in chunk.to_record_batch().schema.names
    }
    ((east, south),) = rows["/bus-7/sky/satellites", "positions"]
    assert np.allclose([east, south], [(30.0, 0.0), (0.0, 60.0)], atol=1e-4)
    assert rows["/bus-7/sky/satellites", "labels"] == [["G12", "R3"]]
    ((green, red),) = rows["/bus-7/sky/satellites", "colors"]
    assert green != red
    assert rows["/bus-7/gps_raw/R3", "scalars"] == [[7.0]]
    assert not [entity for entity, _ in rows if "verdict" in entity]


def test_an_estimate_lies_between_its_sigma_bounds(record: Record) -> None:
    status = FusionStatus(t_ns=at(1), gyro_bias_degps=0.5, gyro_bias_std_degps=0.125)
    rows = record([status, pose(1, alt_m=80.0, alt_std_m=2.0, grade_pct=1.0)])
    assert rows["/bus-7/calibration/gyro_bias_degps"] == [(at(1), [0.5, 0.625, 0.375])]
    assert rows["/bus-7/altitude/fused"] == [(at(1), [80.0, 82.0, 78.0])]
    ((_, [grade_pct, *bounds_pct]),) = rows["/bus-7/grade/fused"]
    assert grade_pct == 1.0
    assert np.isnan(bounds_pct).all(), "a std that is unknown bounds nothing"
    assert "/bus-7/calibration/gyro_scale" not in rows


def test_a_mode_is_a_row_only_where_it_changes(record: Record) -> None:
    modes = ["starting", "starting", "fused", "fused", "lost"]
    rows = record([pose(number * 0.1, mode=mode) for number, mode in enumerate(modes)])
    assert rows["/bus-7/states/mode"] == [
        (at(0.0), ["starting"]),
        (at(0.2), ["fused"]),
        (at(0.4), ["lost"]),
    ]


def test_fast_topics_are_thinned_to_10_hz_and_the_map_to_2_hz(record: Record) -> None:
    rows = record(
        message
        for number in range(200)
        for message in (
            odometer(number * 0.01, 5.0),
            gyro(number * 0.01, 1.0),
            pose(number * 0.01, speed_mps=5.0, heading_deg=90.0),
        )
    )
    assert len(rows["/bus-7/speed/odometer/s"]) == len(rows["/bus-7/speed/fused"]) == 20
    assert len(rows["/bus-7/map/vehicle"]) == len(rows["/bus-7/map/heading"]) == 4
    assert not any("gyro" in entity or "yaw" in entity for entity in rows)


def test_the_path_is_drawn_in_pieces_that_meet_and_not_where_the_vehicle_stands(
    record: Record,
) -> None:
    distances_m = [0.0, 10.0, 20.0, 20.5, 20.5, 30.0]
    rows = record(
        pose(number, lat_deg=LAT_DEG + distance_m * 1e-5, distance_m=distance_m)
        for number, distance_m in enumerate(distances_m)
    )
    pieces = [line for _, [line] in rows["/bus-7/map/path"]]
    assert [t_ns for t_ns, _ in rows["/bus-7/map/path"]] == [at(1), at(2), at(5)]
    assert [piece[0] for piece in pieces[1:]] == [piece[-1] for piece in pieces[:-1]]


def test_no_piece_of_path_leads_from_the_end_of_a_drive_to_its_next_start(record: Record) -> None:
    """A looped drive: the distance travelled starts again from 0."""
    drive = [(0.0, 0.0), (1.0, 50.0), (2.0, 0.0), (3.0, 50.0)]
    rows = record(pose(seconds, distance_m=distance_m) for seconds, distance_m in drive)
    assert [t_ns for t_ns, _ in rows["/bus-7/map/path"]] == [at(1), at(3)]


def test_progress_and_horizon_are_shown(record: Record) -> None:
    progress = Progress(
        t_ns=at(1),
        route_id="r",
        distance_m=5.0,
        lat_deg=LAT_DEG,
        lon_deg=LON_DEG,
        cross_track_m=1.0,
        distance_std_m=1.0,
        on_route=False,
        speed_mps=1.0,
    )
    points = (HorizonPoint(distance_m=0.0, grade_pct=2.5), HorizonPoint(distance_m=20.0))
    rows = record([progress, Horizon(t_ns=at(1), points=points), Horizon(t_ns=at(2))])
    assert rows["/bus-7/map/on_route"] == [(at(1), [[LAT_DEG, LON_DEG]])]
    assert rows["/bus-7/states/route"] == [(at(1), ["off route"])]
    assert rows["/bus-7/grade/earlier_runs"] == [(at(1), [2.5])]


def test_what_each_sensor_says_of_the_slope_lies_beside_what_fusion_says(record: Record) -> None:
    slopes = (
        SensorSlope(sensor="gps_altitude", source="gps-ingest", slope_pct=2.0, slope_std_pct=0.5),
        SensorSlope(sensor="torque", slope_pct=1.5, slope_std_pct=0.1),
    )
    rows = record([FusionStatus(t_ns=at(1), slopes=slopes)])
    assert rows["/bus-7/grade/gps_altitude/gps-ingest"] == [(at(1), [2.0])]
    assert rows["/bus-7/grade/torque"] == [(at(1), [1.5])]


def test_a_route_and_its_stops_hold_at_all_times(record: Record, tmp_path: Path) -> None:
    record([pose(0)], routes={"bus-7": [route()]})
    assert {"/bus-7/map/route", "/bus-7/map/stops"} <= static_entities(tmp_path / "test.rrd")


def test_every_route_that_a_vehicle_may_run_is_drawn(record: Record, tmp_path: Path) -> None:
    record([pose(0)], routes={"bus-7": [route(), route()]})
    chunks = RrdReader(tmp_path / "test.rrd").stream().to_chunks()
    batches = [each.to_record_batch() for each in chunks if each.entity_path == "/bus-7/map/route"]
    (lines,) = (
        batch.column(name).to_pylist()[0]
        for batch in batches
        for name in batch.schema.names
        if name.endswith("line_strings")
    )
    assert len(lines) == 2


def test_each_vehicle_has_its_own_entities(tmp_path: Path) -> None:
    path = tmp_path / "two.rrd"
    with RerunRecording(save=path) as recording:
        recording.log("bus-7", pose(0), "fusion")
        recording.log("7bus", pose(0), "fusion")
    rows = read_back(path)
    assert {"/bus-7/map/vehicle", "/7bus/map/vehicle"} <= set(rows)
    assert len(rows["/bus-7/map/vehicle"]) == 1


def test_rows_wait_for_a_batch_and_are_all_there_at_the_end(tmp_path: Path) -> None:
    with RerunRecording(save=tmp_path / "batch.rrd", batch_s=1.0) as recording:
        for number in range(10):
            recording.log("bus-7", odometer(number * 0.1, 5.0), "s")
        assert recording.rows_sent == 0
        recording.log("bus-7", odometer(1.0, 5.0), "s")
        assert recording.rows_sent == 10
    assert recording.rows_sent == 11
    assert len(read_back(tmp_path / "batch.rrd")["/bus-7/speed/odometer/s"]) == 11


def test_topics_without_a_place_need_not_be_read(record: Record) -> None:
    assert type(gyro(0, 1.0)) not in READS
    assert record([gyro(0, 1.0)]) == {}


def test_a_file_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none/x\.rrd: No such file or directory; name a file"):
        RerunRecording(save=tmp_path / "none" / "x.rrd")


def test_a_blueprint_has_a_page_for_every_vehicle() -> None:
    one, two = make_blueprint({"a": 12.0}), make_blueprint({"b": 12.0, "a": 12.0})
    assert one.root_container.name == "a"
    assert [page.name for page in two.root_container.contents] == ["a", "b"]


def test_everything_that_fusion_learns_has_a_plot() -> None:
    assert {name for name, _ in CALIBRATED} == {*HORIZONTAL, *VERTICAL, *GPS}


def test_the_ellipse_holds_95_percent_and_leans_as_the_covariance_does() -> None:
    line = ellipse_of(pose(0, east_std_m=10.0, north_std_m=10.0, east_north_cov_m2=60.0))
    assert line is not None
    steps = [step_between(LAT_DEG, LON_DEG, lat_deg, lon_deg) for lat_deg, lon_deg in line]
    longest = max(steps, key=lambda step: step.distance_m)
    # variances along north-east and north-west: 160 and 40 m2
    assert longest.distance_m == about(np.sqrt(5.991 * 160.0), 0.05)
    assert min(step.distance_m for step in steps) == about(np.sqrt(5.991 * 40.0), 0.3)
    assert longest.bearing_deg % 180.0 == about(45.0, 4.0)


def test_the_arrow_points_where_the_vehicle_heads() -> None:
    line = arrow_of(pose(0, heading_deg=120.0))
    assert line is not None
    tip = step_between(LAT_DEG, LON_DEG, *line[1])
    assert tip.bearing_deg == about(120.0, 0.1)
    assert tip.distance_m == about(40.0, 0.1)


@pytest.mark.parametrize("shape", [arrow_of, ellipse_of])
def test_nothing_is_drawn_of_what_is_unknown(shape: Callable[[Pose], object]) -> None:
    assert shape(pose(0)) is None
    known = pose(0, lat_deg=None, heading_deg=1.0, east_std_m=1.0, north_std_m=1.0)
    assert shape(known) is None


def test_the_zoom_shows_the_whole_extent() -> None:
    extent = Extent()
    assert extent.zoom() == NEAR_ZOOM
    extent.add(LAT_DEG, LON_DEG)
    assert extent.zoom() == NEAR_ZOOM
    extent.add(LAT_DEG, LON_DEG + 1.0)
    # 600 pixels hold one degree: 256 x 2^zoom pixels are the 360 degrees of the equator
    assert 256.0 * 2.0 ** extent.zoom() / 360.0 == about(600.0, 1e-6)


def test_a_decimator_lets_through_once_a_period_and_survives_a_step_back() -> None:
    decimator = Decimator(100)
    due = [decimator.is_due("a", START_NS + t_ns) for t_ns in (0, 99, 100, 199, 50, 149, 150)]
    assert due == [True, False, True, False, True, False, True]
    assert decimator.is_due("b", START_NS + 151)
