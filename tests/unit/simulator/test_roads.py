"""Roads that are made up: they keep to their design guides, close, and are the same each time."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from wayline.errors import InputError
from wayline.geo import metres_per_degree
from wayline_simulator.alignment import Bend, length_of, sample, straight
from wayline_simulator.closing import gap_of
from wayline_simulator.country_road import HILLS, MAIN, MOTORWAY, Design
from wayline_simulator.course import STEP_M, Course, Floats, Surroundings, repeated
from wayline_simulator.road import make_course
from wayline_simulator.road_model import Kind, RoadModel
from wayline_simulator.road_plan import Stretch
from wayline_simulator.vertical_alignment import Relief, rolling_grade

OPEN_KINDS: tuple[Kind, ...] = ("motorway", "main", "urban", "garage")
LOOP_KINDS: tuple[Kind, ...] = ("motorway", "main", "urban", "hills", "eight")
SEEDS = (1, 2)


def plane_m(course: Course) -> Floats:
    """East and north of the start, shape (n, 2)."""
    north_m, east_m = metres_per_degree(float(course.lats_deg[0]))
    return np.column_stack(
        (
            (course.lons_deg - course.lons_deg[0]) * east_m,
            (course.lats_deg - course.lats_deg[0]) * north_m,
        )
    )


def least_radius_m(course: Course) -> float:
    """Of the sharpest bend."""
    return 1.0 / float(np.max(np.abs(course.curvature_per_m)))


@pytest.mark.parametrize("kind", LOOP_KINDS)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_loop_ends_in_its_beginning(kind: Kind, seed: int) -> None:
    """Position to the millimetre, heading to the microradian, altitude to the millimetre."""
    course = make_course(RoadModel(kind=kind, loop=True), seed)
    gap = gap_of(course)
    assert np.hypot(gap.east_m, gap.north_m) < 1e-3
    assert abs(gap.turn_rad) < 1e-6
    assert abs(course.alts_m[-1] - course.alts_m[0]) < 1e-3
    assert course.curvature_per_m[0] == pytest.approx(course.curvature_per_m[-1], abs=1e-6)
    assert course.grade[0] == pytest.approx(course.grade[-1], abs=1e-6)


def test_a_loop_is_driven_on_without_a_jump() -> None:
    """Where the second lap begins, positions go on a step apart."""
    course = make_course(RoadModel(kind="hills"), 1)
    steps_m = np.hypot(*np.diff(plane_m(repeated(course, 2)), axis=0).T)
    assert np.abs(steps_m - STEP_M).max() < 0.01


@pytest.mark.parametrize("kind", [*OPEN_KINDS, "hills", "eight"])
def test_the_same_seed_gives_the_same_road(kind: Kind) -> None:
    """To the last bit, and another seed gives another."""
    road = RoadModel(kind=kind, tunnels=0 if kind == "garage" else 1)
    first, again, other = (make_course(road, seed) for seed in (5, 5, 6))
    assert first.lats_deg.tobytes() == again.lats_deg.tobytes()
    assert first.alts_m.tobytes() == again.alts_m.tobytes()
    assert first.surroundings.tobytes() == again.surroundings.tobytes()
    assert first.halts == again.halts
    if kind != "eight":  # its plan is drawn, only what stands beside it is chance
        assert first.lats_deg.tobytes() != other.lats_deg.tobytes()


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(("kind", "design"), [("main", MAIN), ("hills", HILLS)])
def test_a_country_road_keeps_to_its_design(kind: Kind, design: Design, seed: int) -> None:
    """No bend, slope or vertical curve is sharper than its guide allows; heights stay sane."""
    relief = design.relief
    course = make_course(RoadModel(kind=kind), seed)
    change_per_m = np.diff(course.grade) / STEP_M
    assert least_radius_m(course) > 149.0
    assert np.abs(course.grade).max() < relief.steepest + 1e-6
    assert -change_per_m.min() < 1.001 / relief.crest_radius_m
    assert change_per_m.max() < 1.001 / relief.sag_radius_m
    assert np.ptp(course.alts_m) < 5.0 * relief.height_m
    assert np.ptp(course.alts_m) > 0.5 * relief.height_m


@pytest.mark.parametrize("seed", SEEDS)
def test_a_motorway_bends_and_climbs_gently_between_its_ramps(seed: int) -> None:
    """Radii of 800 m and more, 4 %, crests of 9500 m; the ramp's loop is tight."""
    course = make_course(RoadModel(kind="motorway"), seed)
    inner = slice(round(1200.0 / STEP_M), -round(1200.0 / STEP_M))
    assert 1.0 / np.abs(course.curvature_per_m[inner]).max() > 799.0
    assert np.abs(course.grade[inner]).max() < 0.04 + 1e-6
    change_per_m = np.diff(course.grade[inner]) / STEP_M
    assert -change_per_m.min() < 1.001 / MOTORWAY.relief.crest_radius_m
    assert 1.0 / course.curvature_per_m[: inner.start].max() == pytest.approx(50.0, rel=0.01)
    limits_kmh = 3.6 * course.limits_mps[inner]
    assert limits_kmh.min() > 109.0
    assert limits_kmh.max() < 131.0


@pytest.mark.parametrize(
    ("kind", "loop"),
    [(kind, False) for kind in OPEN_KINDS[:3]]
    + [("motorway", True), ("main", True), ("urban", True), ("hills", True), ("eight", True)],
)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_road_meets_itself_only_at_another_height(kind: Kind, loop: bool, seed: int) -> None:
    """Places 60 m apart along the road and within 4 m in plan are 5 m apart in height."""
    length_m = 12_000.0 if kind == "motorway" else None
    course = make_course(RoadModel(kind=kind, loop=loop or None, length_m=length_m), seed)
    near = cKDTree(plane_m(course)).query_pairs(4.0, output_type="ndarray")
    along_m = np.abs(np.diff(near, axis=1))[:, 0] * STEP_M
    if loop:
        along_m = np.minimum(along_m, course.length_m - along_m)
    met = near[along_m > 60.0]
    heights_m = np.abs(np.diff(course.alts_m[met], axis=1))
    assert np.all(heights_m > 5.0)
    assert (len(met) > 0) == (kind == "eight" or (kind == "motorway" and not loop))


@pytest.mark.parametrize("seed", SEEDS)
def test_streets_have_corners_lights_and_every_kind_of_sky(seed: int) -> None:
    """Corners of 8 to 15 m, limits of 30 to 50 km/h, lights, at most 5 %."""
    course = make_course(RoadModel(kind="urban", length_m=12_000.0), seed)
    assert 7.9 < least_radius_m(course) < 12.0
    assert 3.6 * course.limits_mps.min() > 29.0
    assert 3.6 * course.limits_mps.max() < 51.0
    assert np.abs(course.grade).max() < 0.05 + 1e-6
    assert set(course.surroundings) >= {Surroundings.STREET, Surroundings.CANYON}
    assert sum(halt.kind == "light" for halt in course.halts) > 20


def test_a_garage_takes_its_time_below_ground() -> None:
    """Street, three turns down, tail first into a bay for 45 s, three turns up, street."""
    course = make_course(RoadModel(kind="garage"), 1)
    inside = course.surroundings == Surroundings.GARAGE
    slow_mps = np.minimum(
        0.95 * course.limits_mps, np.sqrt(1.8 / (abs(course.curvature_per_m) + 1e-9))
    )
    assert np.sum(STEP_M / slow_mps[inside]) + 49.0 == pytest.approx(530.0, abs=15.0)
    first, last = np.flatnonzero(inside)[[0, -1]]
    assert first * STEP_M > 900.0
    assert course.length_m - last * STEP_M > 900.0
    assert course.alts_m[0] == pytest.approx(course.alts_m[-1], abs=1e-6)
    assert np.ptp(course.alts_m) > 15.0
    helix = np.isclose(course.curvature_per_m, 1.0 / 8.0, rtol=0.01)
    assert np.sum(helix) * STEP_M / 8.0 == pytest.approx(2 * 3 * 2 * np.pi, rel=0.05)
    assert np.abs(course.grade[helix]).max() == pytest.approx(0.105, abs=0.002)


def test_a_garage_is_left_forwards() -> None:
    """It reverses from the turn to the bay, nose a quarter to the left, and parks there."""
    course = make_course(RoadModel(kind="garage"), 1)
    turn, park = (h for h in course.halts if h.kind in ("turn", "park"))
    reversed_m = np.flatnonzero(course.backwards) * STEP_M
    assert (turn.kind, park.kind, park.dwell_s) == ("turn", "park", 45.0)
    assert reversed_m[0] == turn.distance_m
    assert reversed_m[-1] + STEP_M == park.distance_m
    swung_rad = np.diff(course.headings_rad[[round(h.distance_m / STEP_M) for h in (turn, park)]])
    assert swung_rad == pytest.approx(-np.pi / 2.0, abs=0.02)


def test_tunnels_canyons_and_stops_are_where_they_were_asked_for() -> None:
    """Explicit stretches to the metre; as many stops as asked, with names and dwells."""
    road = RoadModel(
        kind="main",
        tunnels=(Stretch(start_m=4000.0, length_m=800.0),),
        canyons=(Stretch(start_m=7000.0, length_m=500.0),),
        stops=5,
    )
    course = make_course(road, 2)
    for kind, start_m, end_m in (
        (Surroundings.TUNNEL, 4000.0, 4800.0),
        (Surroundings.CANYON, 7000.0, 7500.0),
    ):
        found_m = np.flatnonzero(course.surroundings == kind) * STEP_M
        assert found_m[0] == start_m
        assert found_m[-1] == end_m - STEP_M
        assert np.all(np.diff(found_m) == STEP_M)
    stops = [halt for halt in course.halts if halt.kind == "stop"]
    assert len({stop.name for stop in stops}) == 5
    assert all(10.0 < stop.dwell_s < 31.0 for stop in stops)


def test_as_many_tunnels_are_dug_as_were_asked_for() -> None:
    """A count makes tunnels apart from each other."""
    course = make_course(RoadModel(kind="motorway", tunnels=3), 2)
    inside = course.surroundings == Surroundings.TUNNEL
    assert np.sum(np.diff(inside.astype(int)) == 1) == 3


@pytest.mark.parametrize(
    ("road", "key"),
    [
        (RoadModel(kind="file"), "road.path"),
        (RoadModel(kind="main", laps=2), "road.laps"),
        (RoadModel(kind="garage", loop=True), "road.loop"),
        (RoadModel(kind="garage", stops=1), "road.stops"),
        (RoadModel(kind="eight", loop=False), "road.loop"),
        (RoadModel(kind="urban", length_m=100.0), "road.length_m"),
        (RoadModel(kind="main", tunnels=(Stretch(start_m=1e5, length_m=1.0),)), "road.tunnels"),
    ],
)
def test_a_road_that_cannot_be_is_refused(road: RoadModel, key: str) -> None:
    """With the key that is wrong."""
    with pytest.raises(InputError, match=key):
        make_course(road, 1)


@pytest.mark.parametrize("turn_deg", [10.0, 40.0, 90.0, -130.0, 270.0])
def test_a_bend_turns_by_its_angle_between_its_tangents(turn_deg: float) -> None:
    """Sampled curvature adds up to the turn, and the end lies its tangent past the crossing."""
    bend = Bend(np.radians(turn_deg), 60.0)
    curvature = sample(bend.elements())
    headings_rad = np.concatenate(([0.0], np.cumsum((curvature[1:] + curvature[:-1]) * STEP_M / 2)))
    middles_rad = (headings_rad[1:] + headings_rad[:-1]) / 2.0
    end_m = STEP_M * np.array([np.sin(middles_rad).sum(), np.cos(middles_rad).sum()])
    leaving = np.array([np.sin(np.radians(turn_deg)), np.cos(np.radians(turn_deg))])
    expected_m = bend.tangent_m * (np.array([0.0, 1.0]) + leaving)
    assert np.degrees(headings_rad[-1]) == pytest.approx(turn_deg, abs=0.01)
    # a whole number of steps stretches the bend by up to a quarter of a metre
    assert np.hypot(*(end_m - expected_m)) < 0.3


def test_samples_cover_all_elements() -> None:
    """A road of elements is sampled to its length, to half a step."""
    elements = [straight(100.3), *Bend(1.0, 30.0).elements(), straight(20.0)]
    assert (len(sample(elements)) - 1) * STEP_M == pytest.approx(length_of(elements), abs=0.25)


def test_grade_is_piecewise_linear() -> None:
    """Its second difference is 0 but at the ends of vertical curves."""
    relief = Relief(0.06, 0.5, 250.0, 800.0, 2600.0, 3000.0, 25.0)
    grade = rolling_grade(20_001, relief, np.random.default_rng(1))
    bent = np.abs(np.diff(grade, 2)) > 1e-12
    # four samples a curve at most (its ends fall between samples), some 20 curves
    assert 20 < np.sum(bent) < 120


@pytest.mark.parametrize("seed", range(8))
def test_an_open_road_goes_one_way(seed: int) -> None:
    """It never turns back, so that it cannot come across itself."""
    course = make_course(RoadModel(kind="main", heading_deg=0.0), seed)
    assert np.degrees(np.abs(course.headings_rad)).max() < 67.0


def test_nobody_waits_at_a_light_in_a_tunnel() -> None:
    """Lights where a tunnel is dug are gone, the others stay."""
    tunnel = Stretch(start_m=2000.0, length_m=2000.0)
    course = make_course(RoadModel(kind="urban", tunnels=(tunnel,)), 1)
    lights_m = np.array([halt.distance_m for halt in course.halts if halt.kind == "light"])
    assert len(lights_m) > 5
    assert not np.any((lights_m >= 2000.0) & (lights_m <= 4000.0))
