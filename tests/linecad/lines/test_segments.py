"""Segments found, labelled and joined on the made scene."""

import cv2
import numpy as np
import pytest

from linecad.geometry import REFERENCE_WIDTH, angles_to, directions_to, vanishing_points
from linecad.line_graph import ManhattanFrame, Segments
from linecad.lines import segments as segments_module
from linecad.lines.segments import (
    GROUP_ACROSS,
    detector_scale,
    find_faint_segments,
    find_segments,
    fit_whole,
    group_segments,
    label_angle,
    label_segments,
)
from linecad.options import SHORT_REACH
from linecad.scene import Camera


@pytest.fixture
def fragments(made):
    """A function that gives a true x segment cut in two, with a gap in px and the second half moved across."""
    ends = made.pixels[np.flatnonzero(made.axis == 0)[0]]
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    middle, normal = ends.mean(axis=0), np.array([-along[1], along[0]])

    def cut(gap, across=0.0):
        halves = np.array([[ends[0], middle - gap / 2 * along], [middle + gap / 2 * along, ends[1]]])
        halves[1] += across * normal
        return Segments(halves, [0, 0])

    return cut


@pytest.mark.parametrize("width", [500, 1600])
def test_the_edges_of_a_drawn_rectangle_are_found(width):
    image = np.full((width * 3 // 4, width), 220, np.uint8)
    low, high = (width // 5, width // 6), (width * 3 // 5, width // 2)
    cv2.rectangle(image, low, high, 60, -1)
    found = find_segments(image)
    assert (found.axis == -1).all()
    long = found.ends[found.length > 0.2 * width]
    assert len(long) == 4
    expected = {(low[0], 0), (high[0], 0), (low[1], 1), (high[1], 1)}
    for place, column in expected:
        off = np.abs(long[:, :, column] - place).max(axis=1)
        assert (off < 1.5).sum() == 1


@pytest.mark.parametrize(("width", "deviation"), [(1600, 8), (1600, 10), (2400, 9)])
def test_the_second_look_finds_more_of_a_faint_edge_in_grain(width, deviation):
    grain = np.random.default_rng(5).normal(0, deviation, (width * 3 // 4, width))
    image = np.full(grain.shape, 120.0) + grain
    image[:, width // 2 :] += 22
    image = np.clip(image, 0, 255).astype(np.uint8)

    def shown(found):
        on_edge = np.abs(found.ends[:, :, 0] - width / 2).max(axis=1) < 3
        return found.length[on_edge].sum() / len(image)

    assert shown(find_faint_segments(image)) > shown(find_segments(image)) + 0.15


def test_texture_is_no_segment():
    image = np.full((600, 800), 220, np.uint8)
    for x in range(20, 780, 20):
        image[300:304, x : x + 4] = 60
    assert len(find_segments(image)) == 0


def test_a_flat_photo_has_no_segments():
    assert len(find_segments(np.full((300, 400), 128, np.uint8))) == 0


def test_labels_are_the_true_axes(made):
    labelled = label_segments(made.noisy(0.3), made.camera, made.frame)
    assert labelled.axis.tolist() == made.axis.tolist()


def test_segments_of_no_axis_are_left_out(made):
    stray = np.array([[[1400.0, 1000.0], [1500.0, 900.0]]])
    labelled = label_segments(Segments(stray, [-1]), made.camera, made.frame)
    assert len(labelled) == 0


def test_a_mast_before_the_end_of_a_street_is_upright(made):
    points = vanishing_points(made.camera.matrix, made.frame.rotation)
    end = points[1, :2] / points[1, 2]
    up = directions_to(end, points[2])
    leaning = up + 0.01 * np.array([-up[1], up[0]])  # it runs through that point exactly, and to the zenith roughly
    for low, high, axis in ((-80.0, 60.0, 2), (-5.0, 200.0, 2), (5.0, 90.0, 1)):
        mast = Segments([[end + low * leaning, end + high * leaning]], [-1])
        assert label_segments(mast, made.camera, made.frame).axis.tolist() == [axis]


def test_labelled_ends_stay_as_they_were(made):
    noisy = made.noisy(0.3)
    assert label_segments(noisy, made.camera, made.frame).ends.tobytes() == noisy.ends.tobytes()


def test_grouped_segments_pass_exactly_through_their_vanishing_points(made):
    labelled = label_segments(made.noisy(0.5), made.camera, made.frame)
    grouped = group_segments(labelled, made.camera, made.frame)
    sines = angles_to(grouped.ends, vanishing_points(made.camera.matrix, made.frame.rotation))
    assert sines[grouped.axis, np.arange(len(grouped))].max() < 1e-9


def test_grouping_leaves_exact_segments_where_they_are(made):
    grouped = group_segments(made.segments, made.camera, made.frame)
    assert len(grouped) == len(made.axis)
    for ends, axis in zip(grouped.ends, grouped.axis, strict=True):
        same = np.array([ends, ends[::-1]])
        candidates = made.pixels[made.axis == axis]
        assert min(np.abs(candidates - one).max(axis=(1, 2)).min() for one in same) < 1e-9


@pytest.mark.parametrize(("share", "pieces"), [(-0.5, 1), (0.1, 1), (0.9, 1), (1.1, 2), (2.0, 2)])
def test_fragments_are_joined_over_short_gaps_only(made, fragments, share, pieces):
    gap = share * SHORT_REACH.largest_gap * made.camera.width / REFERENCE_WIDTH
    grouped = group_segments(fragments(gap), made.camera, made.frame)
    assert len(grouped) == pieces
    if pieces == 1:
        whole = made.pixels[np.flatnonzero(made.axis == 0)[0]]
        assert grouped.length[0] == pytest.approx(np.linalg.norm(whole[1] - whole[0]), abs=1e-9)


@pytest.mark.parametrize(("share", "pieces"), [(0.8, 1), (1.3, 2)])
def test_fragments_side_by_side_are_joined_only_when_near(made, fragments, share, pieces):
    across = share * GROUP_ACROSS.px(made.camera.width)
    grouped = group_segments(fragments(2.0, across), made.camera, made.frame)
    assert len(grouped) == pieces


def test_a_chain_of_fragments_becomes_one_segment(made):
    ends = made.pixels[np.flatnonzero(made.axis == 2)[0]]
    at = np.linspace(0, 1, 11)
    pieces = np.array([ends[0] + np.array([[a], [a + 0.09]]) * (ends[1] - ends[0]) for a in at[:-1]])
    grouped = group_segments(Segments(pieces, np.full(10, 2)), made.camera, made.frame)
    assert len(grouped) == 1
    assert grouped.length[0] == pytest.approx(0.99 * np.linalg.norm(ends[1] - ends[0]))


def test_fragments_of_different_axes_are_never_joined(made, fragments):
    halves = fragments(1.0)
    grouped = group_segments(Segments(halves.ends, [0, 2]), made.camera, made.frame)
    assert sorted(grouped.axis.tolist()) == [0, 2]


def test_it_does_not_matter_how_many_fragments_are_compared_at_a_time(made, monkeypatch):
    labelled = label_segments(made.noisy(0.5).joined(made.noisy(0.3)), made.camera, made.frame)
    at_once = group_segments(labelled, made.camera, made.frame)
    monkeypatch.setattr(segments_module, "PAIRS", 1)
    one_by_one = group_segments(labelled, made.camera, made.frame)
    assert 0 < len(at_once) < len(labelled)
    assert one_by_one.ends.tolist() == at_once.ends.tolist()


def test_nothing_to_group_gives_nothing(made):
    grouped = group_segments(Segments([], []), made.camera, made.frame)
    assert len(grouped) == 0


@pytest.mark.parametrize("rule", [detector_scale, label_angle])
def test_what_small_photos_get_changes_steadily_with_the_width(rule):
    values = np.array([rule(width) for width in range(200, 2000)])
    assert (np.diff(values) <= 0).all()
    assert np.abs(np.diff(values)).max() < 0.002 * values[0]
    assert values[-1] < 0.7 * values[0]


def test_joined_segments_keep_their_labels(made):
    first, second = made.segments.subset(made.axis == 2), made.segments.subset(made.axis == 0)
    both = first.joined(second)
    assert both.axis.tolist() == first.axis.tolist() + second.axis.tolist()
    assert both.ends[len(first) :].tobytes() == second.ends.tobytes()


def test_fragments_on_both_sides_of_their_vanishing_point_stay_apart():
    # Seen from the front, the lines that lead away meet in the middle of the photo.
    camera = Camera(3840, 2160, np.array([[2000.0, 0, 1920], [0, 2000, 1080], [0, 0, 1]]), "file")
    frame = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 0.0, 1.0)
    ends = [[[1700.0, 1080], [1900, 1080]], [[1940.0, 1080], [2100, 1080]]]
    grouped = group_segments(Segments(ends, [1, 1]), camera, frame, 125.0)
    assert len(grouped) == 2


def pieces_of(ends, count, gap, noise, seed=0):
    """A segment (2, 2) in so many pieces, with gaps in px, whose ends are off by `noise` px."""
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    at = ends[0] + np.linspace(0, 1, count + 1)[:, None] * (ends[1] - ends[0])
    pieces = np.stack([at[:-1], at[1:] - gap * along], axis=1)
    return pieces + np.random.default_rng(seed).normal(0, noise, pieces.shape)


def test_a_whole_segment_keeps_its_own_direction(made):
    """It is not turned to the vanishing point by which its fragments were gathered."""
    point = vanishing_points(made.camera.matrix, made.frame.rotation)[0]
    own = np.array([[200.0, 300.0], [700.0, 300.0 + 500 * np.tan(np.radians(0.4))]])
    towards = point[:2] - own.mean(axis=0) * point[2]
    angle = np.arctan2(towards[1], towards[0])
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    own = own.mean(axis=0) + 0.3 * (own - own.mean(axis=0)) @ turn  # not quite in the direction to the point
    whole = fit_whole(pieces_of(own, 4, 2.0, 0.0), point, made.camera.width)
    assert len(whole) == 1
    assert np.degrees(np.arcsin(angles_to(whole, point[None])[0, 0])) == pytest.approx(0.4, abs=0.02)
    assert min(np.abs(whole[0] - one).max() for one in (own, own[::-1])) < 2.1


def test_a_whole_segment_is_better_than_its_fragments(made):
    """Its direction is off by less than half of what theirs are off by."""
    point = vanishing_points(made.camera.matrix, made.frame.rotation)[0]
    ends = made.pixels[np.flatnonzero(made.axis == 0)[0]]
    fragments, together = [], []
    for seed in range(20):
        pieces = pieces_of(ends, 4, 2.0, 0.3, seed)
        whole = fit_whole(pieces, point, made.camera.width)
        assert len(whole) == 1
        fragments.append(angles_to(pieces, point[None])[0])
        together.append(angles_to(whole, point[None])[0])
    assert np.sqrt(np.mean(np.square(together))) < 0.5 * np.sqrt(np.mean(np.square(fragments)))


def test_a_single_fragment_is_whole(made):
    points = vanishing_points(made.camera.matrix, made.frame.rotation)
    for axis in range(3):
        own = made.noisy(0.3).ends[np.flatnonzero(made.axis == axis)[:1]]
        whole = fit_whole(own, points[axis], made.camera.width)
        assert min(np.abs(whole[0] - one).max() for one in (own[0], own[0, ::-1])) < 1e-9


def test_no_fragments_are_no_segments(made):
    point = vanishing_points(made.camera.matrix, made.frame.rotation)[0]
    assert fit_whole(np.zeros((0, 2, 2)), point, made.camera.width).shape == (0, 2, 2)


@pytest.mark.parametrize(("share", "whole"), [(0.8, 1), (1.3, 2)])
def test_whole_segments_end_at_long_gaps(made, fragments, share, whole):
    gap = share * SHORT_REACH.largest_gap * made.camera.width / REFERENCE_WIDTH
    point = vanishing_points(made.camera.matrix, made.frame.rotation)[0]
    assert len(fit_whole(fragments(gap).ends, point, made.camera.width)) == whole
