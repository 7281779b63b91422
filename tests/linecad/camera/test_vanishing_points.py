"""The frame from segments of the made scene."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linecad.camera.vanishing_points import MIN_SEGMENTS, default_focal, find_frame, need_segments
from linecad.errors import ReconstructionError
from linecad.geometry import rotation_about, vanishing_points
from linecad.line_graph import Segments


def angle_between(first, second):
    """rad, without any freedom of names or signs."""
    return Rotation.from_matrix(first.T @ second).magnitude()


def test_frame_of_exact_segments_is_the_true_one(made):
    frame = find_frame(made.unlabelled, made.camera.matrix)
    np.testing.assert_allclose(frame.rotation, made.frame.rotation, atol=1e-7)
    assert frame.residual < 1e-7
    assert frame.explained == pytest.approx(1)


@pytest.mark.parametrize("seed", range(4))
def test_frame_survives_pixel_noise(made, seed):
    frame = find_frame(made.noisy(0.5, seed), made.camera.matrix)
    assert np.degrees(angle_between(frame.rotation, made.frame.rotation)) < 0.2


def test_frame_survives_clutter(made):
    rng = np.random.default_rng(0)
    start = rng.uniform(0, 1200, (40, 2))
    angle = rng.uniform(0, 2 * np.pi, 40)
    clutter = np.stack([start, start + 60 * np.stack([np.cos(angle), np.sin(angle)], axis=1)], axis=1)
    ends = np.concatenate([made.noisy(0.3).ends, clutter])
    frame = find_frame(Segments(ends, np.full(len(ends), -1)), made.camera.matrix)
    assert np.degrees(angle_between(frame.rotation, made.frame.rotation)) < 0.5
    assert 0.6 < frame.explained < 1


@pytest.mark.parametrize("seed", range(4))
def test_order_and_direction_of_segments_do_not_matter(made, seed):
    rng = np.random.default_rng(seed)
    noisy = made.noisy(0.3)
    ends = noisy.ends[rng.permutation(len(noisy))]
    turned = rng.random(len(ends)) < 0.5
    ends = np.where(turned[:, None, None], ends[:, ::-1], ends)
    usual = find_frame(noisy, made.camera.matrix)
    shuffled = find_frame(Segments(ends, np.full(len(ends), -1)), made.camera.matrix)
    np.testing.assert_allclose(shuffled.rotation, usual.rotation, atol=1e-6)


@pytest.mark.parametrize("yaw", np.radians([-80, -44, -30, 0.0, 20, 44, 46, 100, 170]))
def test_axes_are_named_by_how_they_lie_before_the_camera(made, yaw):
    # The same scene with its axes named by someone who stands turned by yaw: the names must come out alike.
    turn = rotation_about(np.array([0.0, 0.0, yaw]))
    rotation = made.frame.rotation @ turn
    points = vanishing_points(made.camera.matrix, rotation)
    rng = np.random.default_rng(3)
    middle = rng.uniform([200, 200], [1400, 1000], (60, 2))
    towards = points[np.arange(60) % 3, :2] - middle * points[np.arange(60) % 3, 2:]
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    ends = np.stack([middle - 50 * towards, middle + 50 * towards], axis=1)
    frame = find_frame(Segments(ends, np.full(60, -1)), made.camera.matrix)
    R = frame.rotation
    assert np.linalg.det(R) == pytest.approx(1)
    assert R[1, 2] < -0.9  # z points up, against the image's y
    assert R[0, 0] > 0  # x points right
    assert R[2, 1] > 0  # y points away
    assert abs(R[2, 0]) <= abs(R[2, 1])  # of the two level axes x is the one that runs more across
    assert np.abs(np.abs(R.T @ rotation).max(axis=0) - 1).max() < 1e-9  # and the three are the scene's axes


def test_the_same_seed_gives_the_same_bits(made):
    noisy = made.noisy(0.5)
    first, second = (find_frame(noisy, made.camera.matrix, seed=7) for _ in range(2))
    assert first.rotation.tobytes() == second.rotation.tobytes()


def test_too_few_segments_are_refused(made):
    few = made.unlabelled.subset(np.arange(MIN_SEGMENTS - 1))
    with pytest.raises(ReconstructionError, match=f"^{MIN_SEGMENTS - 1} straight segments found, at least 12"):
        find_frame(few, made.camera.matrix)
    with pytest.raises(ReconstructionError, match="straight segments found"):
        need_segments(few)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_one_direction_alone_is_refused(made, axis):
    only = made.unlabelled.subset(made.axis == axis)
    ends = np.concatenate([only.ends, only.ends.mean(axis=1, keepdims=True) * 0.2 + only.ends * 0.8])
    with pytest.raises(ReconstructionError, match="run in one direction"):
        find_frame(Segments(ends, np.full(len(ends), -1)), made.camera.matrix)


def test_default_focal_is_that_of_a_28_mm_lens():
    assert default_focal(3600, 2400) == pytest.approx(28 / 36 * 3600, rel=1e-3)
