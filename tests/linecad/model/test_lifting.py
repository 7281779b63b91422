"""Line graphs with known depths, lifted: exact at the chosen crossings, right to the noise."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from linecad.geometry import directions_to, project, vanishing_points
from linecad.graph.build import build_line_graph
from linecad.graph.connectivity import components
from linecad.line_graph import ManhattanFrame, Segments
from linecad.model.lifting import fit_log_depths, lift
from linecad.options import SHORT_REACH
from linecad.scene import Camera

CAMERA = Camera(3840, 2880, np.array([[2500.0, 0, 1919.5], [0, 2500, 1439.5], [0, 0, 1]]), "file")
C, S = np.cos(0.3), np.sin(0.3)
FRAME = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ [[C, -S, 0], [S, C, 0], [0, 0, 1]], 0.0, 1.0)
SHORTEST = 26.0  # px; shorter ones are no nodes

grid_line = st.tuples(
    st.integers(0, 2), st.integers(-4, 4), st.integers(7, 11), st.integers(-3, 3), st.integers(-2, 0), st.integers(1, 3)
)


def in_space(rows):
    """Axis (N,) and ends (N, 2, 3) of grid lines; nothing is at the height of the eye or straight ahead."""
    axis = np.array([row[0] for row in rows])
    ends = np.array([row[1:4] for row in rows], float)[:, None].repeat(2, axis=1) + 0.37
    for i, row in enumerate(rows):
        ends[i, :, axis[i]] += row[4:]
    return axis, ends


def true_log_depths(graph, ends):
    """From the two coordinates that a line keeps, by least squares as in the definition of the nearest point."""
    rays = graph.rays.copy()
    rays[np.arange(len(rays)), graph.axis] = 0
    return np.log((rays * ends[:, 0]).sum(axis=1) / (rays**2).sum(axis=1))


def apart(graph, chosen, lifted):
    """(chosen,) distance of the two lines of each chosen crossing."""
    i, j = graph.edges[chosen].T
    coordinate = graph.coordinate[chosen]
    return np.abs(lifted.ends[i, :, coordinate] - lifted.ends[j, :, coordinate]).max(axis=1, initial=0)


@given(st.lists(grid_line, min_size=2, max_size=14, unique=True), st.integers(0, 2**31), st.floats(0, 0.02))
def test_chosen_crossings_coincide(rows, seed, noise):
    axis, ends = in_space(rows)
    pixels = project(ends, CAMERA.matrix, FRAME.rotation)
    assume((np.linalg.norm(pixels[:, 1] - pixels[:, 0], axis=1) > SHORTEST).all())
    graph = build_line_graph(Segments(pixels, axis), CAMERA, FRAME, replace(SHORT_REACH, extension=60.0))
    i, j = graph.edges.T
    meets = np.abs(ends[i, 0, graph.coordinate] - ends[j, 0, graph.coordinate]) < 1e-9
    rng = np.random.default_rng(seed)
    chosen = meets & (rng.random(len(meets)) < 0.9)
    true = true_log_depths(graph, ends)
    lifted = lift(graph, chosen, true + rng.uniform(-noise, noise, len(rows)))
    size = np.ptp(lifted.ends.reshape(-1, 3), axis=0).max()
    assert apart(graph, chosen, lifted).max(initial=0) <= 1e-9 * size
    # Up to one scale for each group of lines that crossings tie, the true lines come out.
    for part in components(graph, chosen & graph.informative):
        ratio = lifted.offset[part] / ends[part, 0]
        told = ratio[~np.isnan(ratio)]
        assert np.ptp(told) < 1e-6
        assert abs(np.log(told.mean())) <= noise + 1e-6


def moved_by_noise(made, sigma, seed):
    """The exact segments moved across by noise, still through their vanishing points, cut short by up to 3 px."""
    rng = np.random.default_rng(seed)
    middle = made.pixels.mean(axis=1)
    along = made.pixels[:, 1] - made.pixels[:, 0]
    length = np.linalg.norm(along, axis=1)
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / length[:, None]
    middle = middle + normal * rng.normal(0, sigma, len(middle))[:, None]
    points = vanishing_points(made.camera.matrix, made.frame.rotation)[made.axis]
    direction = directions_to(middle, points)
    direction *= np.sign((direction * along).sum(axis=1))[:, None]
    reach = np.stack([-length, length], axis=1) / 2 - rng.uniform(-3, 3, (len(middle), 2))
    return Segments(middle[:, None] + reach[..., None] * direction[:, None], made.axis)


@pytest.fixture(params=range(4))
def noisy(request, made):
    """A line graph of the made scene with noise, its true crossings, and what lifting makes of them."""
    segments = moved_by_noise(made, 0.4, request.param)
    graph = build_line_graph(segments, made.camera, made.frame)
    assert len(graph.segments) == len(made.axis)
    chosen = made.truly_real(graph)
    assert chosen.sum() > 60
    true = np.array([made.depth_at(i, segments.ends[i].mean(axis=0)) for i in range(len(made.axis))])
    return graph, chosen, lift(graph, chosen, np.log(true))


def test_depths_are_right_to_the_noise(made, noisy):
    _, _, lifted = noisy
    for box in (0, 1):
        own = made.box == box
        ratio = np.linalg.norm(np.nan_to_num(lifted.offset[own]), axis=1) / np.linalg.norm(
            np.where(np.isnan(lifted.offset[own]), 0, made.ends[own, 0]), axis=1
        )
        assert np.abs(ratio / np.median(ratio) - 1).max() < 0.03


def test_lines_move_by_about_the_noise_only(made, noisy):
    _, _, lifted = noisy
    assert lifted.shift.max() < 5 / made.camera.focal


def test_noisy_crossings_coincide_too(noisy):
    graph, chosen, lifted = noisy
    assert apart(graph, chosen, lifted).max() == 0


def test_residuals_are_within_the_tolerances(noisy):
    graph, chosen, lifted = noisy
    assert (lifted.residual[chosen] <= graph.tolerance[chosen]).mean() > 0.95


def test_ends_of_l_junctions_are_the_same_point_bit_for_bit(noisy):
    graph, chosen, lifted = noisy
    corners = np.flatnonzero(chosen & (graph.kind == "L"))
    assert len(corners) > 15
    for i, j in graph.edges[corners]:
        assert {end.tobytes() for end in lifted.ends[i]} & {end.tobytes() for end in lifted.ends[j]}


def test_stems_of_t_junctions_end_on_their_bars_bit_for_bit(noisy):
    graph, chosen, lifted = noisy
    stems = np.flatnonzero(chosen & (graph.kind == "T"))
    assert len(stems) > 15
    for edge in stems:
        first, second = graph.edges[edge]
        fits = []
        for stem, bar in ((first, second), (second, first)):
            fixed = graph.axis[bar] != np.arange(3)
            fits += [(end[fixed] == lifted.offset[bar][fixed]).all() for end in lifted.ends[stem]]
        assert any(fits)


def test_a_line_without_chosen_crossings_keeps_the_depth_of_the_solver(made):
    graph = made.graph()
    guess = np.full(len(graph.segments), np.log(5.0))
    lifted = lift(graph, np.zeros(len(graph.edges), bool), guess)
    np.testing.assert_allclose(lifted.ends.mean(axis=(1, 2)).shape, (len(guess),))
    middle = graph.rays * 5.0
    across = np.arange(3) != graph.axis[:, None]
    np.testing.assert_allclose(lifted.offset[across], middle[across], rtol=1e-9)
    assert lifted.shift.max() < 1e-9


def test_ends_are_seen_at_the_ends_of_the_segments(made):
    graph = made.graph()
    true = np.log([made.depth_at(i, ends.mean(axis=0)) for i, ends in enumerate(made.pixels)])
    lifted = lift(graph, made.truly_real(graph), true)
    back = project(lifted.ends, made.camera.matrix, made.frame.rotation)
    np.testing.assert_allclose(back, made.pixels, atol=1e-6)
    np.testing.assert_allclose(lifted.ends, made.ends, rtol=1e-6, atol=1e-6)


def test_inconsistent_depths_are_balanced_by_their_certainty(made):
    # Two of the crossings of a four-cycle disagree by 1 %: the fit spreads what does not close over all four.
    graph = made.graph()
    cycle = components(graph)[0]
    chosen = np.isin(graph.edges, cycle).all(axis=1)
    exact = fit_log_depths(graph, chosen, np.zeros(len(graph.segments)))
    i, j = graph.edges[chosen].T
    np.testing.assert_allclose(exact[i] - exact[j], graph.log_ratio[chosen], atol=1e-8)


def test_a_line_between_two_that_became_one_keeps_its_length():
    """Two bars of nearly one height meet a level line that ends in both corners; a short post stands between them."""
    axis = np.array([0, 0, 1, 2])
    ends = np.array(
        [
            [[1.0, 8, -1.0], [3.0, 8, -1.0]],
            [[1.0, 8, -0.9], [3.0, 8, -0.9]],
            [[1.0, 8, -0.95], [1.0, 10, -0.95]],
            [[2.5, 8, -1.0], [2.5, 8, -0.9]],
        ]
    )
    pixels = project(ends, CAMERA.matrix, FRAME.rotation)
    graph = build_line_graph(Segments(pixels, axis), CAMERA, FRAME, replace(SHORT_REACH, extension=60.0))
    across = {tuple(sorted(edge)) for edge in graph.edges.tolist()}
    assert across >= {(0, 2), (1, 2), (0, 3), (1, 3)}
    chosen = graph.axis[graph.edges[:, 0]] != graph.axis[graph.edges[:, 1]]
    lifted = lift(graph, chosen, true_log_depths(graph, ends))
    height = lifted.ends[:2, 0, 2]
    assert height[0] == height[1]
    post = lifted.ends[3]
    assert np.linalg.norm(post[1] - post[0]) > 0.04
    assert np.abs(post[:, 2] - height[0]).min() == 0
