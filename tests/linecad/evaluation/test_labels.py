"""Labels of segments and crossings in scenes where each is known."""

import numpy as np
import pytest

from linecad.evaluation.frames import true_axes
from linecad.evaluation.labels import FAKE, REAL, UNDECIDED, find_true_lines, label_crossings
from linecad.line_graph import ManhattanFrame, Segments

# Lines in space: (axis, start, end). The near box stands at x -3 to -0.5, y 6 to 8, z -1.5 to 1, the far one behind it.
NEAR_CORNER = (2, (-0.5, 6, -1.5), (-0.5, 6, 1))
NEAR_TOP = (0, (-3, 6, 1), (-0.5, 6, 1))
FAR_TOP = (0, (-0.8, 10, 1.5), (3, 10, 1.5))
PAINT_ON_FAR = (0, (-0.8, 10, 0.8), (0.8, 10, 0.8))
PAINT_ON_GROUND = (0, (-0.4, 5, -1.5), (1.5, 5, -1.5))
PAINT_AWAY = (1, (0.5, 4.5, -1.5), (0.5, 8, -1.5))
PANEL_TOP = (0, (1, 9.92, 0.5), (2, 9.92, 0.5))
PAINT_BESIDE_PANEL = (2, (2.2, 10, -1.2), (2.2, 10, 0.9))


def one_label(scene, first, second):
    graph = scene.graph(first, second)
    assert len(graph.edges) == 1
    return int(label_crossings(scene.truth, graph)[0])


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        (NEAR_CORNER, "edge"),
        (NEAR_TOP, "edge"),
        (PAINT_ON_FAR, "surface"),
        (PAINT_ON_GROUND, "surface"),
        (PAINT_AWAY, "surface"),
    ],
)
def test_edges_and_surface_lines_are_told_apart(corner, line, kind):
    found = find_true_lines(corner.truth, corner.segments(line))
    assert found.kind.tolist() == [kind]
    assert found.right.all()


def test_a_segment_in_the_sky_is_spurious(corner):
    found = find_true_lines(corner.truth, Segments([[[100.0, 20.0], [180.0, 20.0]]], [0]))
    assert found.kind.tolist() == ["spurious"]
    assert not found.right.any()


def test_a_segment_that_follows_an_edge_over_less_than_two_fifths_is_not_that_edge(corner):
    start, end = corner.segment(*FAR_TOP[1:])
    beyond = end + (end - start) * 1.6  # 38 % on the edge, the rest in the sky
    within = end + (end - start) * 1.2  # 45 %
    found = find_true_lines(corner.truth, Segments([[start, beyond], [start, within]], [0, 0]))
    assert found.kind.tolist() == ["spurious", "edge"]


@pytest.mark.parametrize(("across", "kind"), [(1.8, "edge"), (6.0, "surface")])
def test_an_edge_is_within_two_pixels(corner, across, kind):
    ends = corner.segment(*NEAR_TOP[1:]) + np.array([0, across])
    assert find_true_lines(corner.truth, Segments([ends], [0])).kind.tolist() == [kind]


@pytest.mark.parametrize(("degrees", "is_edge"), [(1.2, True), (1.9, False)])
def test_an_edge_is_within_one_and_a_half_degrees(corner, degrees, is_edge):
    start, end = corner.segment(*NEAR_CORNER[1:])
    middle, half = (start + end) / 2, (end - start) / 2 * 0.2  # short, so that the ends stay within 2 px
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    half = np.array([c * half[0] - s * half[1], s * half[0] + c * half[1]])
    found = find_true_lines(corner.truth, Segments([[middle - half, middle + half]], [2]))
    assert (found.kind[0] == "edge") == is_edge


def test_the_line_of_a_surface_segment_lies_on_the_surface(corner):
    found = find_true_lines(corner.truth, corner.segments(PAINT_ON_GROUND, PAINT_AWAY))
    assert found.point[:, 2] == pytest.approx([-1.5, -1.5])
    assert np.abs(found.direction) == pytest.approx(np.array([[1.0, 0, 0], [0, 1, 0]]))


def test_paint_that_runs_along_no_axis_is_wrongly_labelled(corner):
    slanted = corner.segment((-0.2, 4.5, -1.5), (1.5, 6, -1.5))
    found = find_true_lines(corner.truth, Segments([slanted, slanted], [0, 1]))
    assert found.kind.tolist() == ["surface", "surface"]
    assert not found.right.any()


def test_an_edge_labelled_with_another_axis_is_wrong(corner):
    ends = corner.segment(*NEAR_CORNER[1:])
    found = find_true_lines(corner.truth, Segments([ends] * 4, [0, 1, 2, -1]))
    assert found.right.tolist() == [False, False, True, False]


def test_axes_may_have_other_names(corner):
    rotation = corner.frame.rotation
    renamed = np.stack([rotation[:, 1], -rotation[:, 0], rotation[:, 2]], axis=1)  # its x is the true y
    ends = corner.segment(*NEAR_TOP[1:])
    found = find_true_lines(corner.truth, Segments([ends, ends], [0, 1]), renamed)
    assert found.right.tolist() == [False, True]
    assert true_axes(renamed, rotation).tolist() == [1, 0, 2]


def test_a_corner_is_real(corner):
    assert one_label(corner, NEAR_CORNER, NEAR_TOP) == REAL


def test_a_wall_that_a_near_edge_hides_makes_a_fake_crossing(corner):
    assert one_label(corner, NEAR_CORNER, PAINT_ON_FAR) == FAKE


def test_lines_painted_on_one_plane_cross_for_real(corner):
    assert one_label(corner, PAINT_ON_GROUND, PAINT_AWAY) == REAL


def test_a_panel_a_little_before_the_wall_is_undecided(corner):
    assert one_label(corner, PANEL_TOP, PAINT_BESIDE_PANEL) == UNDECIDED


def test_a_crossing_with_a_spurious_line_is_fake(corner):
    graph = corner.graph((2, (2.5, 10, 1.6), (2.5, 10, 3)), FAR_TOP)
    assert find_true_lines(corner.truth, graph.segments).kind.tolist() == ["spurious", "edge"]
    assert label_crossings(corner.truth, graph).tolist() == [FAKE]


def test_pieces_of_one_edge_are_one_line_and_of_two_are_not(corner):
    left, right = (0, (-0.6, 10, 1.5), (0.4, 10, 1.5)), (0, (1, 10, 1.5), (2.5, 10, 1.5))
    graph = corner.graph(left, right, collinear=True)
    assert graph.kind.tolist() == ["collinear"]
    assert label_crossings(corner.truth, graph).tolist() == [REAL]
    graph = corner.graph(NEAR_TOP, (0, (0, 6, 1), (1.5, 6, 1)), collinear=True)  # goes on in the air, over the far wall
    assert graph.kind.tolist() == ["collinear"]
    assert label_crossings(corner.truth, graph).tolist() == [FAKE]


def test_every_crossing_of_the_made_boxes_has_its_true_label(made, made_truth):
    graph = made.graph(extension=900.0)  # far enough that lines of different faces cross
    label = label_crossings(made_truth, graph)
    assert set(label.tolist()) == {REAL, FAKE}
    assert (label == REAL).tolist() == made.truly_real(graph).tolist()


def test_labels_do_not_hang_on_pixel_noise(made, made_truth):
    rng = np.random.default_rng(3)
    noisy = Segments(made.pixels + rng.normal(0, 0.3, made.pixels.shape), made.axis)
    assert find_true_lines(made_truth, noisy, ManhattanFrame(made.frame.rotation, 0.0, 1.0).rotation).right.all()
