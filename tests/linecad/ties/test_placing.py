"""The stage as a whole, on exact made walls: their scales are found, and annotations are kept to."""

from collections import defaultdict
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import linecad.ties.depth_ties
import linecad.ties.placing
import linecad.ties.weights
from linecad.errors import ContradictionError, SolverError
from linecad.ties.candidates import find_candidates
from linecad.ties.evidence import FITS
from linecad.ties.looks import Looks
from linecad.ties.placing import place_lines
from solver.options import SolveOptions

NEAR, FAR = 9.5, 12.0
PLACED = 0.005  # log depth: half the width of a peak of levels


def placed(seen, **more):
    return place_lines(seen.graph, seen.sight, SolveOptions(**more))


def off(seen, found):
    """By how much log depths are off between the two parts: the median of the first less that of the second."""
    error = found.solution.log_depth - seen.log_depth
    first, second = (error[seen.part == part] for part in range(2))
    return float(np.median(first) - np.median(second))


def between(seen):
    """The crossings of the two parts."""
    return np.flatnonzero(np.diff(seen.part[seen.graph.edges])[:, 0])


@pytest.fixture(scope="module")
def street(build_town, build_row):
    """Two walls of equal heights, the second set back, with a course of the first before it.

    The camera is turned, so that no line's rays have one depth, and signs of depths matter.
    """
    first, second = build_row(1, at=(NEAR, FAR), level=True, end=1.7)
    shorter = second[:8] + second[12:]  # without some uprights, so that the first wall is the larger body
    return build_town(first, shorter, yaw=-0.05)


@pytest.fixture(scope="module")
def usual(street):
    return placed(street)


@pytest.fixture(scope="module")
def facade(build_town, build_row):
    """Two walls in one plane that one course joins."""
    return build_town(*build_row(1))


@pytest.fixture(scope="module")
def corner(build_town, build_wall):
    """Two walls that meet in an edge, whose courses meet there in points."""
    heights = np.linspace(-2.4, 2.1, 7)
    across, away = np.linspace(2.0, 3.6, 6), np.array([6.0, 6.6, 7.4, 8.4, 10.0, 13.0])
    return build_town(build_wall(1, 6.0, across, heights), build_wall(0, 2.0, away, heights)[1:])


@pytest.fixture(scope="module")
def triangle(build_town):
    """A line away from the camera, an upright at 12 and a level line at 9 cross in the photo: two of the three may."""
    lines = [(0, (0.0, 9.0, -1.0), (3.0, 9.0, -1.0)), (2, (1.0, 12.0, -2.0), (1.0, 12.0, 1.0))]
    return build_town([*lines, (1, (1.0, 8.0, -1.11), (1.0, 14.0, -1.11))])


def test_walls_are_placed_where_they_stand(street, usual):
    assert usual.setting.bodies.count == 2
    assert abs(off(street, usual)) < PLACED
    inside = usual.solution.log_depth - street.log_depth
    assert all(np.ptp(inside[(street.part == part) & (np.arange(44) != 15)]) < 1e-6 for part in range(2))


def test_the_answer_is_proven_over_bodies(usual):
    solution = usual.solution
    assert (solution.status, solution.formulation, solution.gap) == ("optimal", "bodies", 0.0)
    assert solution.objective == solution.bound == pytest.approx(usual.ties.value(usual.placement.log_scale))
    assert solution.objective > 0
    assert usual.reference == 0
    assert len(usual.setting.fits.present) == FITS


def test_crossings_are_connected_where_they_agree(street, usual):
    misfit = street.graph.misfit(usual.solution.log_depth)
    told = street.graph.informative
    assert usual.solution.connected[told & (misfit < 1e-6)].all()
    assert not usual.solution.connected[told & (misfit > 0.1)].any()
    assert not usual.solution.connected[between(street)].any(), "the course passes before the second wall"


def test_walls_at_a_corner_are_one_body_in_place(corner):
    found = placed(corner)
    assert found.setting.bodies.count == 1
    error = found.solution.log_depth - corner.log_depth
    assert np.ptp(error) < 1e-6
    assert (len(found.ties), found.solution.status, found.solution.objective) == (0, "optimal", 0.0)
    assert found.solution.is_boundary.any()
    assert (found.probability > 0.5).all()


def test_a_crossing_called_real_is_kept_to(street, usual):
    edge = int(between(street)[2])
    assert not usual.solution.connected[edge]
    found = placed(street, real=(edge,))
    assert found.solution.connected[edge]
    assert street.graph.misfit(found.solution.log_depth)[edge] < 1e-6
    assert off(street, found) == pytest.approx(np.log(FAR / NEAR), abs=0.005), "the walls are in one plane then"


def test_crossings_called_fake_are_not_taken(facade):
    edges = between(facade)
    assert placed(facade).solution.connected[edges].all()
    found = placed(facade, fake=tuple(edges.tolist()))
    assert not found.solution.connected[edges].any()
    kinds = {candidate.kind for candidate in find_candidates(found.setting, Looks(found.setting))}
    assert "bundle" not in kinds, "what is fake is no evidence"


def test_fake_crossings_hold_no_body_together(build_town, build_row):
    seen = build_town(*build_row(6))
    assert placed(seen).setting.bodies.count == 1
    found = placed(seen, fake=tuple(between(seen).tolist()))
    assert found.setting.bodies.count == 2
    assert not found.solution.connected[between(seen)].any()


def test_annotations_that_contradict_each_other_are_named(triangle):
    assert triangle.graph.edges.tolist() == [[0, 1], [0, 2], [1, 2]]
    for real in combinations(range(3), 2):
        found = placed(triangle, real=real)
        assert found.solution.connected[list(real)].all()
        assert (found.setting.graph.misfit(found.setting.log_depth)[list(real)] < 1e-3).all(), "the fit keeps to them"
    with pytest.raises(ContradictionError, match="cannot all be real") as caught:
        placed(triangle, real=(0, 1, 2))
    assert caught.value.lines == (0, 1, 2)


def test_crossings_called_real_hold_where_neither_fit_nor_ties_keep_to_them(triangle, monkeypatch):
    monkeypatch.setattr(linecad.ties.placing, "CERTAIN", 1.0)
    for real in combinations(range(3), 2):
        found = placed(triangle, real=real)
        over = triangle.graph.misfit(found.solution.log_depth) - triangle.graph.tolerance
        assert (over[list(real)] < 1e-6).all()


def test_a_crossing_that_the_graph_has_not_is_refused(facade):
    with pytest.raises(SolverError, match="called real, but the graph has"):
        placed(facade, real=(len(facade.graph.edges),))
    with pytest.raises(SolverError, match="both real and fake"):
        placed(facade, real=(0,), fake=(0,))


def test_two_runs_give_the_same_bytes(street, usual):
    again = placed(street)
    for one, other in ((usual.solution, again.solution), (usual.placement, again.placement), (usual.ties, again.ties)):
        for name, value in vars(one).items():
            if isinstance(value, np.ndarray):
                assert value.tobytes() == getattr(other, name).tobytes(), name
    assert usual.probability.tobytes() == again.probability.tobytes()


def test_colours_speak_for_walls_and_against_them(facade):
    """Two walls of one plane are one house if they have one colour."""
    alike = np.full((2880, 3840, 3), (150, 120, 100), np.uint8)
    different = alike.copy()
    different[:, 1728:] = (60, 90, 190)
    weights = []
    for pixels in (alike, different):
        ties = place_lines(facade.graph, replace(facade.sight, pixels=pixels), SolveOptions()).ties
        weights.append(ties.weight[(ties.bodies < 2).all(axis=1)].sum())
    assert weights[0] > weights[1]


def test_lines_that_are_too_few_for_a_body_keep_the_fit(build_town, build_wall):
    upright, *_, course = build_wall(1, 10.0, np.array([-4.0, -3.0]), np.array([-1.0, 1.0]))
    seen = build_town([upright, course])
    found = placed(seen)
    assert found.setting.bodies.count == 0
    assert found.probability.tolist() == [0.0, 0.0]
    assert found.solution.status == "optimal"
    assert found.solution.connected.tolist() == [True]
    assert np.ptp(found.solution.log_depth - seen.log_depth) < 1e-9


def test_a_graph_without_lines_is_placed(facade):
    found = place_lines(facade.graph.subset(np.zeros(0, int)), facade.sight, SolveOptions())
    assert (len(found.solution.log_depth), len(found.probability), found.solution.objective) == (0, 0, 0.0)


def test_lines_of_no_body_keep_the_fit(build_town, build_row, build_wall):
    stray = build_wall(1, 10.0, np.array([-0.2, 0.0]), np.array([-0.3, 0.3]))[:1]
    first, second = build_row(1)
    seen = build_town(first, second, stray)
    found = placed(seen)
    assert found.setting.bodies.body[-1] == -1
    assert found.probability[-1] == 0
    assert found.solution.log_depth[-1] == found.setting.log_depth[-1]


def test_the_way_is_told(street):
    stages, reports = [], []
    place_lines(street.graph, street.sight, SolveOptions(), reports.append, stages.append)
    assert stages[0].startswith("fitting depths")
    assert stages[1:] == ["finding what ties 2 bodies", f"placing 2 bodies by {len(placed(street).ties)} ties"]
    assert reports
    for report in reports:
        assert report.bound >= report.objective - 1e-9


def test_the_seed_is_that_of_the_options(street, usual):
    other = placed(street, seed=5)
    assert (other.setting.fits.present != usual.setting.fits.present).any()
    assert abs(off(street, other)) < PLACED


def test_bodies_that_nothing_else_ties_are_put_on_one_ground(brick_lane, monkeypatch):
    lane, height = brick_lane
    # What the network is sure of counts, however the table is fitted.
    sure = defaultdict(float, clear=1.0)
    monkeypatch.setattr(linecad.ties.weights, "LOG_ODDS", {**linecad.ties.weights.LOG_ODDS, "ground": sure})
    monkeypatch.setattr(linecad.ties.weights, "AT_ONCE", {**linecad.ties.weights.AT_ONCE, "ground": 0.0})
    blind = place_lines(lane.graph, replace(lane.sight, pixels=None), SolveOptions())
    assert (blind.setting.bodies.count, len(blind.ties)) == (2, 0)
    assert abs(off(lane, blind)) > 0.1
    found = placed(lane)
    assert {tuple(pair) for pair in found.ties.bodies.tolist()} == {(0, 2), (1, 2)}
    assert abs(off(lane, found)) < 0.03
    assert found.solution.status == "optimal"
    too_large = found.solution.log_depth[0] - lane.log_depth[0]
    assert found.placement.log_scale[2] - too_large == pytest.approx(np.log(height), abs=0.03), "the camera is so high"


def test_a_real_crossing_outweighs_all_other_ties(street):
    found = placed(street, real=(int(between(street)[2]),))
    assert found.ties.weight[-1] > 1000 * found.ties.weight[:-1].sum()
    assert found.ties.tolerance[-1] == street.graph.tolerance[between(street)[2]]
    assert found.placement.counted[-1]


def with_map(seen, depth, **more):
    return place_lines(seen.graph, replace(seen.sight, depth=depth), SolveOptions(**more))


def errors(seen, found):
    """By how much log depths of each part are off, relative to the first."""
    error = found.solution.log_depth - seen.log_depth
    off = np.array([np.median(error[seen.part == part]) for part in range(seen.part.max() + 1)])
    return off - off[0]


@pytest.fixture
def heard_by_the_program(monkeypatch):
    """However little a map's word is worth, as it is where crossings never contradict each other."""
    monkeypatch.setattr(linecad.ties.depth_ties, "LEAST_WORTH", 0.0)


@pytest.fixture(scope="module")
def terrace(build_town, build_wall, build_facade, small_camera):
    """Two walls in one plane that one course joins, seen at an angle, and their surfaces with the second moved away."""
    random = np.random.default_rng(7)
    heights, others = (np.linspace(-2.7, 2.7, 10) + random.uniform(-0.2, 0.2, 10) for _ in range(2))
    first = build_wall(1, 10.0, np.linspace(-3.3, 0.6, 9), heights)
    first[12][2][0] = 6.5
    second = build_wall(1, 10.0, np.linspace(3.2, 8.0, 9), others)

    def surfaces(by):
        return [
            build_facade(1, 10.0, (-4.0, 1.5), (-3.5, 3.5)),
            build_facade(1, 10.0 * by, (2.5 * by, 8.5 * by), (-3.5 * by, 3.5 * by)),
        ]

    return build_town(first, second, yaw=0.2, camera=small_camera), surfaces


@pytest.mark.parametrize(
    ("kind", "scale", "shift"),
    [("z", 1.0, 0.0), ("z", 40.0, 0.0), ("distance", 0.1, 0.0), ("inverse", 3.0, 0.0), ("affine-inverse", 1.0, 0.4)],
)
def test_a_map_puts_bodies_where_they_stand(avenue_walls, build_depth_map, kind, scale, shift):
    seen, surfaces = avenue_walls
    alone = place_lines(seen.graph, seen.sight, SolveOptions())
    assert len(alone.ties) == 0
    assert np.abs(errors(seen, alone)).max() > 0.1
    depth = build_depth_map(seen.sight, surfaces, kind, scale, shift)
    found = with_map(seen, depth)
    np.testing.assert_allclose(errors(seen, found), 0.0, atol=0.02 if shift else 0.001)
    by_map = [set(found.by_map[seen.part == part].tolist()) for part in range(3)]
    assert by_map == [{part != found.reference} for part in range(3)]
    report = found.depth_map
    assert (report.file, report.left_out, report.kind) == ("map.npz", "", kind)
    if not shift:
        relative = np.exp(np.median(seen.log_depth - found.solution.log_depth))
        assert report.scale == pytest.approx(scale * relative, rel=0.01), "of the map over the solution"


@pytest.mark.usefixtures("heard_by_the_program")
def test_the_program_hears_a_map(avenue_walls, build_depth_map):
    """As one more body beside the ground, with a tie to each of the three."""
    seen, surfaces = avenue_walls
    found = with_map(seen, build_depth_map(seen.sight, surfaces))
    assert found.ties.bodies.tolist() == [[body, 4] for body in range(3)]
    assert len(found.placement.log_scale) == 5
    assert found.placement.counted.all()
    np.testing.assert_allclose(errors(seen, found), 0.0, atol=0.001)
    assert found.by_map.sum() == len(seen.part) - (seen.part == found.reference).sum()


@pytest.mark.usefixtures("heard_by_the_program")
def test_the_ground_stands_behind_the_bodies_also_where_a_map_is_heard(avenue_walls, build_depth_map):
    seen, surfaces = avenue_walls
    found = with_map(seen, build_depth_map(seen.sight, surfaces))
    bodies = found.setting.bodies.count
    assert found.places.scale_with_ground[:bodies].tolist() == found.places.log_scale[:bodies].tolist()
    assert found.places.scale_with_ground[bodies:].tolist() == [found.placement.log_scale[bodies]]
    moved = replace(found.places, mapped=replace(found.places.mapped, ground=0.7))
    assert moved.scale_with_ground[bodies:].tolist() == [0.7]


@pytest.mark.usefixtures("heard_by_the_program")
@pytest.mark.parametrize("by", [0.99, 1.0, 1.01, 1.015])
def test_a_map_does_not_move_what_a_bundle_holds(terrace, build_depth_map, by):
    """Not even by less than the bundle's tolerance."""
    seen, surfaces = terrace
    alone = place_lines(seen.graph, seen.sight, SolveOptions())
    assert alone.placement.counted.any()
    assert abs(off(seen, alone)) < 1e-6
    found = with_map(seen, build_depth_map(seen.sight, surfaces(by)))
    assert found.depth_map.left_out == ""
    assert len(found.ties) == len(alone.ties) + 2
    assert found.placement.counted.all()
    assert abs(off(seen, found)) < 1e-6
    assert not found.by_map.any()


def test_what_is_left_out_changes_nothing_but_the_report(avenue_walls, build_depth_map):
    seen, surfaces = avenue_walls
    alone = place_lines(seen.graph, seen.sight, SolveOptions())
    exact = build_depth_map(seen.sight, surfaces)
    shuffled = np.random.default_rng(0).permutation(exact.values[exact.valid])
    values = exact.values.copy()
    values[exact.valid] = shuffled
    for bad in (replace(exact, values=values), replace(exact, values=np.where(exact.valid, 4.0, 0.0))):
        found = with_map(seen, bad)
        assert found.depth_map.left_out
        assert found.solution.log_depth.tobytes() == alone.solution.log_depth.tobytes()
        assert found.probability.tobytes() == alone.probability.tobytes()
        assert not found.by_map.any()
    assert alone.depth_map is None


def test_a_real_crossing_outweighs_a_map(terrace, build_depth_map):
    """The map has the second wall a tenth farther away than a person says."""
    seen, surfaces = terrace
    edge = int(between(seen)[0])
    found = with_map(seen, build_depth_map(seen.sight, surfaces(1.1)), real=(edge,))
    assert found.solution.connected[edge]
    assert abs(off(seen, found)) < 0.005
