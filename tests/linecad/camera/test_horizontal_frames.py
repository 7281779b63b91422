"""The horizontal frames of made segments: angles, counts, what is one frame, and what does not matter."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from linecad.camera.horizontal_frames import find_horizontal_frames, only_frame
from linecad.geometry import central_camera, directions_to, rotation_about, vanishing_points
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera

WIDTH, HEIGHT = 1200, 800
CAMERA = Camera(WIDTH, HEIGHT, central_camera(1000.0, WIDTH, HEIGHT), "file")
LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # world to camera, looking along y
ROTATION = rotation_about(np.array([0.1, 0, 0])) @ LEVEL @ rotation_about(np.array([0, 0, 0.6]))
FRAME = ManhattanFrame(ROTATION, 0.001, 0.8)
MANY = (60, 60, 80)  # segments along x, y, z


def turned(degrees):
    """The rotation of a frame that is turned about the upright from x towards y."""
    return ROTATION @ rotation_about(np.array([0, 0, np.radians(degrees)]))


def along(rotation, counts, seed=0, noise=0.0, length=80.0):
    """Segments (N, 2, 2) px along the axes of a world that the camera sees turned so, noise px across their ends."""
    rng = np.random.default_rng(seed)
    points = vanishing_points(CAMERA.matrix, rotation)[np.repeat(np.arange(3), counts)]
    middle = rng.uniform([0, 0], [WIDTH, HEIGHT], (len(points), 2))
    reach = length / 2 * directions_to(middle, points)
    across = reach[:, ::-1] * [1, -1] / (length / 2)
    off = rng.normal(0, noise, (2, len(points), 1)) * across
    return np.stack([middle - reach + off[0], middle + reach + off[1]], axis=1)


def clutter(count, seed=1):
    """Segments (count, 2, 2) px in all directions."""
    rng = np.random.default_rng(seed)
    middle, angle = rng.uniform([0, 0], [WIDTH, HEIGHT], (count, 2)), rng.uniform(0, np.pi, count)
    reach = 40 * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.stack([middle - reach, middle + reach], axis=1)


def segments(*ends):
    joined = np.concatenate(ends)
    return Segments(joined, np.full(len(joined), -1))


def find(*ends, frame=FRAME):
    return find_horizontal_frames(segments(*ends), CAMERA, frame)


def turns(found):
    return sorted(np.degrees(frame.turn) for frame in found.further)


@given(st.floats(-45, 45).filter(lambda degrees: abs(degrees) > 3), st.floats(0, 0.3), st.integers(0, 1000))
@settings(max_examples=15)
def test_a_turned_house_is_found_with_its_angle(degrees, noise, seed):
    found = find(along(ROTATION, MANY, seed, noise), along(turned(degrees), (40, 40, 0), seed + 1, noise))
    assert len(found.further) == 1
    off = (turns(found)[0] - degrees + 45) % 90 - 45
    assert abs(off) < 3 * np.degrees(found.further[0].error)
    assert abs(off) < 0.3
    assert -45 <= turns(found)[0] <= 45


@pytest.mark.parametrize("angles", [(10.0,), (-20.0, 12.0), (-30.0, -8.0, 15.0)])
def test_every_house_of_a_street_is_a_frame(angles):
    others = [along(turned(angle), (35, 35, 0), 2 + number, 0.2) for number, angle in enumerate(angles)]
    found = find(along(ROTATION, (90, 90, 80), 0, 0.2), *others, clutter(60))
    assert turns(found) == pytest.approx(sorted(angles), abs=0.3)
    evidence = [frame.evidence for frame in found.frames]
    assert found.frames[0].turn == 0.0
    assert evidence == sorted(evidence, reverse=True)


@pytest.mark.parametrize("seed", range(3))
def test_a_photo_of_one_frame_keeps_it_as_it_is(seed):
    found = find(along(ROTATION, MANY, seed, 0.3), clutter(120, seed))
    assert found.main is FRAME
    assert len(found.frames) == 1
    assert_array_equal(found.directions, ROTATION.T)


def test_without_segments_of_more_than_the_axes_there_is_one_frame():
    assert len(find(along(ROTATION, MANY)).frames) == 1


def test_a_few_lines_are_no_frame():
    assert len(find(along(ROTATION, MANY), along(turned(30), (3, 2, 0), 2)).frames) == 1


@pytest.mark.parametrize("degrees", [0.3, 0.8, 1.4])
def test_frames_that_the_errors_do_not_tell_apart_are_one(degrees):
    assert len(find(along(ROTATION, MANY, 0, 0.3), along(turned(degrees), (40, 40, 0), 1, 0.3)).frames) == 1


def test_the_verges_of_a_gable_are_no_frame():
    """Many parallel edges side by side, as of the boards of a verge, hit the horizon in one place whatever they are."""
    rng = np.random.default_rng(3)
    start = np.array([300.0, 200.0]) + rng.uniform(0, 1, (60, 1)) * [200, -110] + rng.uniform(-6, 6, (60, 2))
    verge = np.stack([start, start + np.array([70.0, -38.5])], axis=1)
    assert len(find(along(ROTATION, (90, 90, 80), 0, 0.3), verge).frames) == 1


def test_a_start_between_two_houses_is_parted():
    """The single frame of two houses of equal right lies between them, and its upright suffers."""
    ends = [along(turned(degrees), (70, 70, 40), seed, 0.2) for seed, degrees in enumerate((-2.5, 2.5))]
    found = find(*ends)
    assert len(found.frames) == 2
    apart = abs(np.degrees(found.further[0].turn))
    assert apart == pytest.approx(5.0, abs=0.3)
    azimuth = np.degrees(np.arctan2(*(ROTATION.T @ found.main.rotation[:, 0])[[1, 0]]))
    assert (abs(azimuth) + 45) % 90 - 45 == pytest.approx(2.5, abs=0.3) or abs(azimuth) == pytest.approx(87.5, abs=0.3)


@pytest.mark.parametrize("seed", range(4))
def test_houses_three_degrees_apart_are_told_apart_where_a_third_is_turned_more(seed):
    """With tails as long as those that find the camera, two of the three are found as their mean."""
    ends = [
        along(ROTATION, (60, 60, 80), seed, 0.4, 40.0),
        along(turned(3), (20, 20, 0), seed + 10, 0.4, 40.0),
        along(turned(15), (50, 50, 0), seed + 20, 0.4, 40.0),
    ]
    found = find(*ends, clutter(40, seed))
    x = ROTATION.T @ found.main.rotation[:, 0]
    azimuth = np.degrees(np.arctan2(x[1], x[0]) + [frame.turn for frame in found.frames])
    assert sorted((azimuth + 45) % 90 - 45) == pytest.approx([0.0, 3.0, 15.0], abs=0.7)


@pytest.mark.parametrize("seed", range(3))
def test_frames_too_small_to_be_given_lines_part_no_other(seed):
    """The lines of a wall that is 3 degrees off were left out with a frame of their own."""
    found = find(
        along(ROTATION, (150, 150, 150), seed, 0.4, 60.0),
        along(turned(3), (15, 15, 0), seed + 10, 0.4, 40.0),
        along(turned(25), (12, 12, 0), seed + 20, 0.4, 50.0),
    )
    assert all(abs(turn) > 10 for turn in turns(found))
    assert len(found.sound.frames) == 1
    assert found.frames[0].share > 0.64


def test_the_main_frame_is_that_with_the_most_evidence():
    found = find(along(ROTATION, (25, 25, 40), 0, 0.2), along(turned(20), (120, 120, 40), 1, 0.2))
    assert [round(turn) for turn in turns(found)] in ([-20], [70])
    across = found.main.rotation[:, :2].T @ turned(20)[:, :2]
    assert np.abs(across).max() > np.cos(np.radians(0.5))


def test_the_order_of_segments_does_not_matter():
    ends = np.concatenate([along(ROTATION, MANY, 0, 0.2), along(turned(17), (40, 40, 0), 1, 0.2), clutter(50)])
    order = np.random.default_rng(0).permutation(len(ends))
    first, second = find(ends), find(ends[order])
    assert_allclose(first.directions, second.directions, atol=1e-4)
    labels = first.labelled(segments(ends), CAMERA)
    assert_array_equal(labels[order], second.labelled(segments(ends[order]), CAMERA))


def test_segments_are_labelled_by_their_direction():
    """Those that point to two directions alike, near the horizon, may take either."""
    counts = (40, 40, 40)
    other = along(turned(30), counts, 1, 0.1)
    found = find(along(ROTATION, (90, 90, 80), 0, 0.1), other)
    label = found.labelled(segments(other), CAMERA)
    true = vanishing_points(CAMERA.matrix, turned(30))[np.repeat(np.arange(3), counts)]
    given_points = (found.directions @ CAMERA.matrix.T)[label]
    assert (label >= 0).mean() > 0.95
    middle = other.mean(axis=1)
    cosine = np.abs((directions_to(middle, true) * directions_to(middle, given_points)).sum(axis=1))
    assert (cosine[label >= 0] > np.cos(np.radians(1.0))).mean() > 0.97
    assert set(label[80:][label[80:] >= 0].tolist()) == {2}
    assert (found.labelled(segments(clutter(300, 5)), CAMERA) == -1).mean() > 0.5


def test_directions_are_the_main_axes_and_then_two_for_each_frame():
    found = find(along(ROTATION, (90, 90, 80), 0, 0.2), along(turned(25), (40, 40, 0), 1, 0.2))
    directions = found.directions
    assert directions.shape == (5, 3)
    assert found.shares.shape == (6,)
    assert found.shares.sum() == pytest.approx(1.0)
    assert_allclose(directions[:3], found.main.rotation.T)
    assert_allclose(directions[3:] @ directions[2], 0, atol=1e-12)
    assert directions[3] @ directions[4] == pytest.approx(0, abs=1e-12)
    x, y = directions[:2] @ directions[3]
    assert np.arctan2(y, x) == pytest.approx(found.further[0].turn)


def test_a_given_frame_stays_alone():
    """A frame that a person drew is the only one, whatever else the photo shows."""
    ends = segments(along(ROTATION, MANY), along(turned(30), (60, 60, 0), 1))
    found = only_frame(ends, CAMERA, FRAME)
    assert found.main is FRAME
    assert not found.further


def test_shares_are_of_the_segment_length():
    found = find(along(ROTATION, (60, 60, 80), 0, 0.1), along(turned(30), (50, 50, 0), 1, 0.1))
    assert sum(frame.share for frame in found.frames) == pytest.approx(220 / 300, abs=0.03)
    assert found.further[0].share == pytest.approx(100 / 300, abs=0.06)
