"""Lines along each vanishing point, found where they are too faint for a detector of fragments."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from hypothesis.extra.numpy import arrays

from linecad.evaluation.datasets import find_dataset
from linecad.evaluation.frames import true_axes
from linecad.evaluation.measure import covered_length
from linecad.evaluation.references import open_case
from linecad.finding import find_lines
from linecad.geometry import angles_to, central_camera, rotation_about, vanishing_points
from linecad.line_graph import ManhattanFrame
from linecad.lines import vanishing_point_lines
from linecad.lines.segments import find_segments
from linecad.lines.vanishing_point_lines import START, _runs, find_vanishing_point_lines, least_evidence
from linecad.scene import Camera

WIDTH, HEIGHT = 640, 480
FRONTAL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # x to the right, z up, y away, into the photo's middle
VIEWS = {"frontal": (0, 0, 0), "turned": (0, 0.6, 0), "turned and tilted": (0.3, 0.5, 0.1)}


def seen(view: str, width: int = WIDTH, height: int = HEIGHT) -> tuple[Camera, ManhattanFrame]:
    camera = Camera(width, height, central_camera(0.9 * width, width, height), "file")
    return camera, ManhattanFrame(rotation_about(np.array(VIEWS[view])) @ FRONTAL, 0.0, 1.0)


def with_edge(ends: np.ndarray, step: float, noise: float, width: int = WIDTH, height: int = HEIGHT) -> np.ndarray:
    """A grey photo, brighter by `step` in a strip to the left of a segment (2, 2)."""
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    x, y = np.meshgrid(np.arange(width) - ends[0, 0], np.arange(height) - ends[0, 1])
    place, across = x * along[0] + y * along[1], x * along[1] - y * along[0]
    strip = np.clip(across + 0.5, 0, 1) * (across < 60 * width / WIDTH)
    strip *= (place >= 0) & (place <= np.linalg.norm(ends[1] - ends[0]))
    photo = 120 + step * strip + np.random.default_rng(5).normal(0, noise, strip.shape)
    return np.clip(np.round(photo), 0, 255).astype(np.uint8)


def edge_towards(camera: Camera, frame: ManhattanFrame, axis: int, length: float) -> np.ndarray:
    """A segment (2, 2) beside the photo's middle that points to the vanishing point of an axis."""
    vanishing = vanishing_points(camera.matrix, frame.rotation)[axis]
    place = np.array([0.62 * camera.width, 0.4 * camera.height])
    away = vanishing[:2] - place * vanishing[2]
    return place + np.array([[-0.5], [0.5]]) * length * away / np.linalg.norm(away)


def overlap(found: np.ndarray, ends: np.ndarray, reach: float = 1.0) -> float:
    """The share of a segment along which some found segments (N, 2, 2) run within `reach` px."""
    at = ends[0] + np.linspace(0.01, 0.99, 99)[:, None] * (ends[1] - ends[0])
    covered = np.zeros(len(at), bool)
    for first, second in found:
        along = (second - first) / np.linalg.norm(second - first)
        place = (at - first) @ along
        across = np.abs((at - first) @ [-along[1], along[0]])
        covered |= (across <= reach) & (place >= 0) & (place <= np.linalg.norm(second - first))
    return float(covered.mean())


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("view", VIEWS)
def test_a_line_near_the_noise_is_found_where_no_fragment_stands_out(view, axis):
    camera, frame = seen(view)
    ends = edge_towards(camera, frame, axis, 150)
    photo = with_edge(ends, step=11, noise=4)
    lines = find_vanishing_point_lines(photo, camera, frame)
    assert overlap(find_segments(photo).ends, ends, reach=1.5) < 0.3
    assert overlap(lines.ends[lines.axis == axis], ends, reach=1.5) > 0.8


@pytest.mark.parametrize("view", VIEWS)
def test_noise_has_no_lines(view):
    photo = np.random.default_rng(0).normal(120, 12, (HEIGHT, WIDTH)).clip(0, 255).astype(np.uint8)
    assert len(find_vanishing_point_lines(photo, *seen(view))) == 0


def test_a_flat_photo_has_no_lines():
    assert len(find_vanishing_point_lines(np.full((HEIGHT, WIDTH), 128, np.uint8), *seen("turned"))) == 0


@pytest.mark.parametrize("view", VIEWS)
def test_lines_pass_through_their_vanishing_points(view):
    camera, frame = seen(view)
    photo = with_edge(edge_towards(camera, frame, 2, 200), step=40, noise=2)
    lines = find_vanishing_point_lines(photo, camera, frame)
    sines = angles_to(lines.ends, vanishing_points(camera.matrix, frame.rotation))
    assert len(lines) > 0
    assert sines[lines.axis, np.arange(len(lines))].max() < 1e-5


def test_a_line_ends_where_its_edge_ends():
    camera, frame = seen("turned")
    ends = edge_towards(camera, frame, 2, 150)
    lines = find_vanishing_point_lines(with_edge(ends, step=30, noise=2), camera, frame)
    upright = lines.ends[(lines.axis == 2) & (np.abs(lines.ends[..., 0] - ends[0, 0]).max(axis=1) < 1)]
    assert len(upright) == 1
    assert np.sort(upright[0, :, 1]) == pytest.approx(np.sort(ends[:, 1]), abs=4)


@pytest.mark.parametrize("view", VIEWS)
def test_what_is_not_in_the_photo_tells_nothing_of_it(view, monkeypatch):
    camera, frame = seen(view)
    photo = with_edge(edge_towards(camera, frame, 2, 300), 20, 4)
    found = find_vanishing_point_lines(photo, camera, frame)
    monkeypatch.setattr(vanishing_point_lines, "_within_photo", lambda grid, *_: grid)
    everywhere = find_vanishing_point_lines(photo, camera, frame)
    assert len(found)
    np.testing.assert_array_equal(found.ends, everywhere.ends)


def test_two_lines_far_apart_on_one_row_stay_two():
    camera, frame = seen("turned")
    ends = edge_towards(camera, frame, 2, 300)
    first, second = (ends[0] + np.array([[low], [high]]) * (ends[1] - ends[0]) for low, high in [(0, 0.35), (0.65, 1)])
    photo = np.maximum(with_edge(first, step=30, noise=0), with_edge(second, step=30, noise=0))
    lines = find_vanishing_point_lines(photo, camera, frame)
    on_row = lines.subset((lines.axis == 2) & (np.abs(lines.ends[..., 0] - ends[0, 0]).max(axis=1) < 1))
    assert len(on_row) == 2


def test_wide_photos_are_left_to_the_fragments():
    camera, frame = seen("turned", 1280, 960)
    ends = edge_towards(camera, frame, 2, 600)
    assert len(find_vanishing_point_lines(with_edge(ends, 40, 2, 1280, 960), camera, frame)) == 0


@given(some.integers(16, 1400))
def test_the_evidence_asked_for_grows_steadily_with_the_width(width):
    here, wider = least_evidence(width), least_evidence(width + 1)
    assert here <= wider
    assert wider <= 1.03 * here or width > 1200  # no jump: it goes to infinity at 1280 px


@given(arrays(np.float32, (3, 7), elements=some.floats(-30, 30, width=16)))
def test_runs_are_the_best_of_all_courses(evidence):
    row, start, end = _runs(evidence)
    for number, places in enumerate(evidence):
        own = [(first, last) for r, first, last in zip(row, start, end, strict=True) if r == number]
        found = sum(places[first : last + 1].sum() - START for first, last in own)
        best = max(_worth(places, course) for course in product([0, 1], repeat=7))
        assert found == pytest.approx(best, abs=1e-3)


def _worth(places: np.ndarray, course: tuple[int, ...]) -> float:
    """What a course of on (1) and off (0) earns."""
    switched = np.diff((0, *course)) == 1
    return float(places[np.array(course, bool)].sum() - START * switched.sum())


def test_faint_lines_of_a_small_photo_reach_the_line_graph(photographs):
    photo, reference = open_case(
        next(c for c in find_dataset(photographs / "york_urban").cases if c.name == "P1020867")
    )
    found = find_lines(photo)
    axis = true_axes(found.frame.rotation, reference.rotation)[found.segments.axis]
    marked = reference.lines
    length = np.linalg.norm(marked.ends[:, 1] - marked.ends[:, 0], axis=1).sum()
    assert covered_length(marked.ends, marked.axis, found.segments.ends, axis) > 0.65 * length
