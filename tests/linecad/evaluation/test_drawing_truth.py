"""Faces against the truth of a made photo: drawn as they are, moved, turned and left out."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.evaluation.drawing import score_drawing
from linecad.evaluation.drawing_truth import is_clutter
from linecad.evaluation.references import reference_of
from linecad.scene import Face, Intersections, Lines, Plane, Scene, SolveReport

GROUND = [(-30, 2), (30, 2), (30, 80), (-30, 80)]
FRONT = [(-2.5, -1.5), (3, -1.5), (3, 1.5), (-2.5, 1.5)]  # of the far box
SEEN_FRONT = [(0, -1.5), (3, -1.5), (3, 1.5), (0, 1.5)]  # what the near box does not hide
NEAR_FRONT = [(-3, -1.5), (-0.5, -1.5), (-0.5, 1), (-3, 1)]


@pytest.fixture
def score(corner):
    """A function from faces, each (axis, offset, outline), and the scale of the scene to its score."""

    def score(faces, scale=1.0, truth=corner.truth, known=True):
        planes = [
            Plane(
                number, axis, scale * offset, (),
                (Face(number, scale * np.insert(np.array(outline, float), axis, offset, axis=1)),),
            )
            for number, (axis, offset, outline) in enumerate(faces)
        ]  # fmt: skip
        nothing = Lines([], [], np.zeros((0, 2, 2)), np.zeros((0, 2, 3)), [], [], [])
        scene = Scene(
            "a.jpg", corner.camera, corner.frame.rotation, nothing,
            Intersections(np.zeros((0, 2)), [], np.zeros((0, 2)), [], [], []), tuple(planes),
            SolveReport("none", "gain", "optimal", 0.0, 0.0, 0.0),
        )  # fmt: skip
        return score_drawing(scene, reference_of(truth), scale if known else None)

    return score


def test_what_is_drawn_as_it_is_is_right(score):
    found = score([(2, -1.5, GROUND), (1, 10.0, FRONT), (1, 6.0, NEAR_FRONT)], 2.0)
    truth = found.truth
    assert truth.right_axis == truth.right_plane
    assert truth.right_axis / truth.covered > 0.98  # but for the sides of the boxes, which are left out
    assert truth.covered / truth.pixels == found.known_covered > 0.95
    assert truth.ground_height == pytest.approx(0)
    assert truth.ground_covered > 0.99
    assert (truth.has_one_ground, truth.has_right_height) == (True, True)


def test_a_wall_at_a_wrong_depth_has_the_right_axis_alone(score):
    right, moved = (score([(1, place, SEEN_FRONT)]).truth for place in (10.0, 10.8))
    assert right.right_plane == right.right_axis > 0
    assert moved.right_plane == 0
    assert moved.right_axis > 0


def test_a_face_of_another_axis_is_wrong(score):
    # The ground beside the boxes, drawn as a wall.
    wall = score([(1, 40.0, [(15, -12), (30, -12), (30, -2), (15, -2)])]).truth
    assert wall.covered > 0
    assert wall.right_axis / wall.covered < 0.1


def test_a_face_in_the_sky_is_told(score):
    sky = [(-30, 10), (30, 10), (30, 40), (-30, 40)]  # above the boxes
    above = score([(1, 40.0, sky)]).truth
    assert above.covered == 0
    assert above.sky_covered > 0.3 * above.sky > 0
    assert score([(2, -1.5, GROUND)]).truth.sky_covered == 0


def test_without_a_scale_no_plane_is_right(score):
    truth = score([(2, -1.5, GROUND)], known=False).truth
    assert truth.right_axis > 0
    assert (truth.right_plane, truth.ground_height, truth.has_right_height) == (0, None, False)
    assert truth.has_one_ground is True


@pytest.mark.parametrize(("height", "right"), [(-1.45, True), (-1.35, False)])
def test_the_height_of_the_ground_is_measured(score, height, right):
    truth = score([(2, height, GROUND)]).truth
    assert truth.ground_height == pytest.approx(height / -1.5 - 1)
    assert truth.has_right_height is right


def test_half_a_ground_is_not_one(score):
    halves = [[(-30, 2), (0, 2), (0, 80), (-30, 80)], [(0, 2), (30, 2), (30, 80), (0, 80)]]
    truth = score([(2, -1.5, half) for half in halves]).truth
    assert 0.5 < truth.ground_covered < 0.8
    assert truth.has_one_ground is False
    assert score([(1, 10.0, FRONT)]).truth.ground_covered == 0


def test_small_bodies_are_clutter(corner, score):
    # The near box, 2.5 m wide, as a body of its own; the ground and the far box remain one.
    body = np.r_[np.ones(6, int), np.zeros(len(corner.truth.quads) - 6, int)]
    apart = replace(corner.truth, body=body)
    assert is_clutter(apart).tolist() == [True] * 6 + [False] * (len(body) - 6)
    assert not is_clutter(corner.truth).any()
    assert score([], truth=apart).truth.pixels < score([]).truth.pixels
    assert score([], truth=apart).known_covered == 0
