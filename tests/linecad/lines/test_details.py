"""Details: faint edges that are found at all, and segments apart from others."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.geometry import central_camera, segment_coordinates
from linecad.line_graph import ManhattanFrame, Segments
from linecad.lines.details import LEAST_STRETCH, TWIN, apart_from, find_details, find_whole_details, repeats
from linecad.lines.segments import find_segments
from linecad.scene import Camera

WIDTH, HEIGHT = 1600, 900
LEAST, ACROSS = LEAST_STRETCH.px(WIDTH), TWIN.px(WIDTH)
CAMERA = Camera(WIDTH, HEIGHT, central_camera(1200.0, WIDTH, HEIGHT), "file")
# The camera looks along y, so x runs from left to right in the photo and z upwards.
FRAME = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 0.0, 1.0)


def grained(step, seed=3, width=WIDTH, height=HEIGHT):
    """A grey photo with grain, brighter by `step` below its middle."""
    grey = np.random.default_rng(seed).normal(120.0, 1.0, (height, width))
    grey[height // 2 :] += step
    return grey.clip(0, 255).astype(np.uint8)


def shown(grey):
    """A photo without colour, and itself in grey."""
    return np.repeat(grey[..., None], 3, axis=2), grey


def painted(step, seed=5):
    """A photo with grain whose lower half differs by `step` of b of CIE Lab, and nothing else."""
    lab = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    lab[..., 0] = np.random.default_rng(seed).normal(60.0, 0.5, (HEIGHT, WIDTH))
    lab[HEIGHT // 2 :, :, 2] += step
    return np.rint(cv2.cvtColor(lab, cv2.COLOR_Lab2RGB) * 255).astype(np.uint8)


def level(segments, at):
    """The length, px, of segments on the horizontal line `at`."""
    on = np.abs(segments.ends[..., 1] - at).max(axis=1) < 2.0
    return float(segments.length[on].sum())


def test_details_show_more_of_a_faint_edge_than_segments_to_build_on():
    grey = grained(8.0)
    assert level(find_details(*shown(grey)), HEIGHT / 2 - 0.5) > 0.7 * WIDTH
    assert level(find_segments(grey), HEIGHT / 2 - 0.5) == 0


def test_an_edge_of_colour_alone_is_found():
    photo = painted(12.0)
    grey = cv2.cvtColor(photo, cv2.COLOR_RGB2GRAY)
    assert level(find_details(photo, grey), HEIGHT / 2 - 0.5) > 0.9 * WIDTH
    assert level(find_details(*shown(grey)), HEIGHT / 2 - 0.5) < 0.2 * WIDTH


def test_grain_without_colour_shows_no_edges_of_colour():
    photo, grey = shown(grained(0.0))
    blank = np.full_like(grey, 120)
    assert len(find_details(photo, blank)) == 0


def test_a_whole_line_stands_out_by_its_length_with_its_axis():
    grey = grained(4.0)
    whole = find_whole_details(grey, CAMERA, FRAME)
    along = whole.subset(whole.axis == 0)
    assert level(along, HEIGHT / 2 - 0.5) > 0.9 * WIDTH
    assert level(find_whole_details(grained(0.0), CAMERA, FRAME), HEIGHT / 2 - 0.5) == 0


@pytest.mark.parametrize("width", [640, 1920, 4000])
def test_details_are_in_the_pixels_of_the_photo(width):
    height = width // 2
    grey = np.full((height, width), 90, np.uint8)
    grey[:, width // 4 :] = 180
    found = find_details(*shown(grey))
    assert len(found)
    assert (found.axis == -1).all()
    np.testing.assert_allclose(found.ends[..., 0], width // 4 - 0.5, atol=width / 1000)


def test_what_runs_beside_another_goes_and_the_rest_stays():
    own = Segments(np.array([[[100.0, 50], [500, 50]]]), np.array([2]))
    others = Segments(
        np.array([[[200.0, 50.5], [300, 50]], [[350, 60], [400, 60]], [[420, 50], [450, 50]]]), np.array([2, 2, 0])
    )
    left = apart_from(own, others, WIDTH)
    assert left.ends.tolist() == [[[100, 50], [200, 50]], [[300, 50], [500, 50]]]
    assert left.axis.tolist() == [2, 2]


def test_short_rests_are_left_out():
    own = Segments(np.array([[[0.0, 0], [100, 0]]]), np.array([0]))
    others = Segments(np.array([[[LEAST - 0.1, 0.0], [100, 0]]]), np.array([0]))
    assert len(apart_from(own, others, WIDTH)) == 0
    assert len(apart_from(own, Segments.none(), WIDTH)) == 1


@given(
    spans=st.lists(st.tuples(st.floats(0, 300), st.floats(0, 300), st.floats(-8, 8)), max_size=5),
    angle=st.floats(0, 2 * np.pi),
)
def test_what_is_left_is_every_place_that_no_other_runs_beside(spans, angle):
    """Against places one px apart, looked at one by one."""
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    ends = [[low * along + off * across, high * along + off * across] for low, high, off in spans]
    others = Segments(np.array(ends).reshape(-1, 2, 2), np.zeros(len(spans), np.int64))
    own = Segments(np.array([[0 * along, 300 * along]]), np.array([0]))
    left = apart_from(own, others, WIDTH)
    place = np.sort(segment_coordinates(left.ends, own.ends[0])[0], axis=1)
    free = [
        not any(abs(off) <= ACROSS and min(low, high) <= at <= max(low, high) for low, high, off in spans)
        for at in np.arange(0.5, 300)
    ]
    found = [bool(((place[:, 0] <= at) & (at <= place[:, 1])).any()) for at in np.arange(0.5, 300)]
    # What is left is free but for rounding of the offsets at the limit; free runs that are long enough are left.
    runs = np.split(np.arange(300), np.flatnonzero(np.diff(free)) + 1)
    for run in runs:
        wanted = free[run[0]] and len(run) > LEAST + 2
        if wanted or not free[run[0]]:
            assert [found[at] for at in run[1:-1]] == [wanted] * len(run[1:-1]) or _at_the_limit(spans)


def _at_the_limit(spans):
    return any(abs(abs(off) - ACROSS) < 1e-9 for _, _, off in spans)


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(0, 12))
def test_runs_beside_others_are_those_of_all_pairs(seed, count):
    """Against every pair, looked at one by one; the boxes of the others are only a way to them."""
    rng = np.random.default_rng(seed)
    ends = rng.uniform(0, 60, (2, 12, 2, 2)) * [1.0, 0.1]  # nearly level, so that many run beside others
    axis = rng.integers(0, 2, (2, 12))
    own, others = Segments(ends[0], axis[0]), Segments(ends[1, :count], axis[1, :count])
    found = repeats(own, others, WIDTH)
    for row in range(len(own)):
        wanted = []
        for other in range(count):
            place, beside = segment_coordinates(others.ends[other], own.ends[row])
            runs = (np.abs(beside) <= ACROSS).all() and place.max() > 0 and place.min() < own.length[row]
            wanted += [(place.min(), place.max())] if runs and own.axis[row] == others.axis[other] else []
        np.testing.assert_allclose(np.reshape(found[row], (-1, 2)), np.reshape(wanted, (-1, 2)))
