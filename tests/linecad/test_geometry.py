"""Lengths, rays, projection, vanishing points, rotations and segments against their definitions."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from linecad.geometry import (
    REFERENCE_WIDTH,
    PhotoLength,
    angle_between_frames,
    angles_to,
    central_camera,
    depths_beside,
    directions_to,
    distances_to,
    gaps_between,
    homogeneous,
    plane_normals,
    project,
    reach_across,
    ring_sides,
    rotation_about,
    segment_coordinates,
    unit_normals,
    vanishing_points,
    world_rays,
)

small = st.floats(-3, 3)


def test_homogeneous_points_end_in_one():
    assert homogeneous(np.array([[2.0, 3.0]])).tolist() == [[2.0, 3.0, 1.0]]


def test_a_world_ray_has_camera_depth_one(made):
    rays = world_rays(made.pixels, made.camera.matrix, made.frame.rotation)
    np.testing.assert_allclose((rays @ made.frame.rotation.T)[..., 2], 1, atol=1e-12)


@given(st.tuples(st.floats(0, 1600), st.floats(0, 1200)), st.floats(0.1, 1e4))
def test_a_point_on_a_pixels_ray_projects_to_the_pixel(made, pixel, depth):
    ray = world_rays(np.array(pixel), made.camera.matrix, made.frame.rotation)
    back = project(depth * ray, made.camera.matrix, made.frame.rotation)
    np.testing.assert_allclose(back, pixel, atol=1e-8)


def test_a_vanishing_point_is_where_a_line_along_the_axis_ends(made):
    points = vanishing_points(made.camera.matrix, made.frame.rotation)
    far = project(np.array([0.3, 1e9, -0.2]), made.camera.matrix, made.frame.rotation)
    np.testing.assert_allclose(points[1, :2] / points[1, 2], far, atol=1e-5)


def test_every_true_segment_points_to_the_vanishing_point_of_its_axis_only(made):
    sines = angles_to(made.pixels, vanishing_points(made.camera.matrix, made.frame.rotation))
    every = np.arange(len(made.axis))
    assert sines[made.axis, every].max() < 1e-12
    assert sines[(made.axis + 1) % 3, every].min() > 0.01


def test_direction_to_a_vanishing_point_at_infinity():
    directions = directions_to(np.array([[10.0, 20.0]]), np.array([[-3.0, 4.0, 0.0]]))
    np.testing.assert_allclose(directions, [[-0.6, 0.8]])


def test_direction_to_a_finite_vanishing_point():
    directions = directions_to(np.array([[10.0, 20.0]]), np.array([[26.0, 40.0, 2.0]]))
    np.testing.assert_allclose(directions, [[1.0, 0.0]], atol=1e-15)


def test_angle_of_a_segment_is_measured_at_its_middle():
    sines = angles_to(np.array([[[0.0, 0.0], [10.0, 0.0]]]), np.array([[5.0 + 3.0, 3.0, 1.0]]))
    np.testing.assert_allclose(sines, [[np.sin(np.pi / 4)]])


def test_plane_normals_are_square_to_both_rays_and_to_the_true_axis(made):
    normals = plane_normals(made.pixels, made.camera.matrix)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
    axes = made.frame.rotation[:, made.axis].T
    np.testing.assert_allclose((normals * axes).sum(axis=1), 0, atol=1e-12)


@given(st.tuples(small, small, small))
def test_rotation_about_a_vector_agrees_with_scipy(vector):
    np.testing.assert_allclose(rotation_about(np.array(vector)), Rotation.from_rotvec(vector).as_matrix(), atol=1e-9)


def test_rotation_about_nothing_is_the_identity():
    assert rotation_about(np.zeros(3)).tolist() == np.eye(3).tolist()


@pytest.mark.parametrize("angle", [1e-14, 1e-8, np.pi])
def test_rotation_stays_orthogonal_for_tiny_and_half_turns(angle):
    turned = rotation_about(angle * np.array([0.6, 0.0, 0.8]))
    np.testing.assert_allclose(turned @ turned.T, np.eye(3), atol=1e-14)


def test_central_camera_looks_through_the_middle_of_the_photo():
    assert central_camera(500, 640, 481).tolist() == [[500, 0, 319.5], [0, 500, 240], [0, 0, 1]]


@pytest.mark.parametrize("names", list(permutations(range(3))))
@pytest.mark.parametrize("signs", [(1, 1, 1), (-1, 1, 1), (-1, -1, -1)])
def test_names_and_signs_of_axes_are_free_in_the_angle_between_frames(names, signs):
    true = rotation_about(np.array([0.2, -0.3, 0.4]))
    found = np.empty((3, 3))
    found[:, list(names)] = true * signs
    error, which = angle_between_frames(found, true)
    assert error < 1e-7
    assert which == names


@pytest.mark.parametrize("degrees", [0.01, 1.0, 20.0])
def test_the_angle_between_frames_is_that_of_the_turn(degrees):
    true = rotation_about(np.array([0.2, -0.3, 0.4]))
    axis = np.array([2.0, -1.0, 2.0]) / 3
    error, which = angle_between_frames(rotation_about(np.radians(degrees) * axis) @ true, true)
    assert np.degrees(error) == pytest.approx(degrees, rel=1e-5)
    assert which == (0, 1, 2)


def test_a_length_grows_with_the_photo_and_never_falls_below_its_floor():
    length = PhotoLength(30.0, floor=5.0)
    assert [length.px(width) for width in (7680, REFERENCE_WIDTH, 1280, 320)] == [60, 30, 10, 5]
    assert PhotoLength(30.0).px(REFERENCE_WIDTH / 100) == pytest.approx(0.3)


def test_segment_coordinates_are_along_and_to_the_right():
    ends = np.array([[[1.0, 1.0], [1.0, 5.0]], [[0.0, 0.0], [3.0, 4.0]]])  # down, and down to the right
    place, beside = segment_coordinates(np.array([0.0, 5.0]), ends)
    np.testing.assert_allclose(place, [4, 4])
    np.testing.assert_allclose(beside, [1, 3])
    both, _ = segment_coordinates(np.array([[0.0, 5.0], [3.0, 4.0], [0.0, 0.0]])[:, None], ends)
    np.testing.assert_allclose(both, [[4, 4], [3, 5], [-1, 0]])


def test_a_segment_without_length_has_no_direction():
    assert segment_coordinates(np.array([3.0, 4.0]), np.zeros((2, 2))) == (0, 0)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_ray_passes_nearest_to_a_line_at_its_depth(axis):
    rng = np.random.default_rng(axis)
    rays, points = rng.normal(size=(5, 3)), rng.normal(size=(5, 3))
    depth = depths_beside(rays, points, np.full(5, axis))
    across = np.delete(np.arange(3), axis)

    def distance(at):
        return np.linalg.norm((rays * at[:, None] - points)[:, across], axis=1)

    assert (distance(depth) <= np.minimum(distance(depth + 1e-3), distance(depth - 1e-3))).all()
    met = depths_beside(rays, 3 * rays + 7 * np.eye(3)[axis], np.full(5, axis))
    assert met == pytest.approx(np.full(5, 3.0))


def test_sides_of_rings_lead_from_corner_to_corner_and_back():
    ring = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
    sides = ring_sides([ring, ring + 5])
    assert sides.shape == (6, 2, 3)
    np.testing.assert_array_equal(sides[:3, 0], ring)
    np.testing.assert_array_equal(sides[:3, 1], ring[[1, 2, 0]])
    np.testing.assert_array_equal(sides[3:], sides[:3] + 5)
    assert ring_sides([]).shape == (0, 2, 3)


@given(st.integers(0, 2**32 - 1))
def test_a_segment_reaches_across_a_point_on_it_and_not_across_one_beyond(seed):
    rng = np.random.default_rng(seed)
    ends = rng.uniform(-100, 100, (8, 2, 2))
    share = np.array([-0.5, -0.01, 0.01, 0.3, 0.7, 0.99, 1.01, 2.0])
    points = ends[:, 0] + share[:, None] * (ends[:, 1] - ends[:, 0])
    weight = rng.uniform(0.1, 3.0, 8) * rng.choice([-1.0, 1.0], 8)
    found = reach_across(ends, np.column_stack([points, np.ones(8)]) * weight[:, None])
    assert np.diag(found).tolist() == [False, False, True, True, True, True, False, False]
    assert not reach_across(ends, np.array([[1.0, 2.0, 0.0]])).any()  # nothing reaches what is at infinity


def coordinates(count):
    return st.lists(small, min_size=3 * count, max_size=3 * count).map(lambda each: np.array(each).reshape(count, 3))


@given(points=coordinates(2), segment=coordinates(2))
def test_the_distance_to_a_segment_is_the_least_of_its_points(points, segment):
    along = segment[0] + np.linspace(0, 1, 2001)[:, None] * (segment[1] - segment[0])
    least = np.linalg.norm(points[:, None] - along, axis=2).min(axis=1)
    np.testing.assert_allclose(distances_to(points, segment[None])[:, 0], least, atol=1e-2)
    assert (distances_to(points, segment[None])[:, 0] <= least + 1e-9).all()


@given(segment=coordinates(2), other=coordinates(2))
def test_the_gap_between_segments_is_the_least_between_their_points(segment, other):
    share = np.linspace(0, 1, 301)[:, None]
    along = segment[0] + share * (segment[1] - segment[0])
    least = distances_to(along, other[None]).min()
    found = gaps_between(segment, other[None])[0]
    assert least - 0.04 <= found <= least + 1e-9


def test_the_gap_is_found_between_crossing_parallel_and_far_segments():
    segment = np.array([[-1.0, 0, 0], [1, 0, 0]])
    others = np.array([[[0, -1, 0.5], [0, 1, 0.5]], [[0, 0.25, 0], [5, 0.25, 0]], [[2, 0, 0], [3, 0, 0]]])
    np.testing.assert_allclose(gaps_between(segment, others), [0.5, 0.25, 1.0])


def test_normals_are_a_quarter_turn_from_vectors_and_of_length_1():
    vectors = np.array([[3.0, 4.0], [-2.0, 0.0], [0.0, 1e-200], [0.0, 0.0]])
    found = unit_normals(vectors)
    assert np.allclose((found * vectors).sum(axis=1), 0)
    assert np.allclose(found[:2], [[-0.8, 0.6], [0.0, -1.0]])
    assert found[3].tolist() == [0.0, 0.0]
