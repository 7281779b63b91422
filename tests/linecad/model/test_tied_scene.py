"""Two houses of two storeys each, from segments to a scene: what no crossing connects, the window grids tie."""

from types import SimpleNamespace

import numpy as np
import pytest

from linecad.finding import FoundLines
from linecad.geometry import project
from linecad.line_graph import ManhattanFrame, Segments
from linecad.options import SHORT_REACH, Options
from linecad.pipeline import reconstruct_lines
from linecad.scene import Camera

X, Y, Z = 0, 1, 2
SHIFT = 1e-3  # relative; the segments are exact but for rounding


def storey(wall, jambs, heights):
    """Jambs that cross sills, transoms and heads in the plane x = wall."""
    lines = [(Z, (wall, at, heights[0]), (wall, at, heights[-1])) for at in jambs]
    return lines + [(Y, (wall, jambs[0], at), (wall, jambs[-1], at)) for at in heights]


@pytest.fixture(scope="module")
def street():
    near, far = [8.0, 9.3, 10.4, 11.7, 13.1, 14.2], [17.0, 18.9, 20.1, 23.4, 25.2]
    parts = [
        storey(-6.0, near, [-1.2, 0.1, 0.8]),
        storey(-6.0, near, [2.4, 3.3, 4.0]),
        storey(9.0, far, [-0.6, 0.4, 1.5]),
        storey(9.0, far, [3.9, 5.2, 6.0]),
    ]
    lines = [line for part in parts for line in part]
    camera = Camera(3840, 2160, np.array([[1900.0, 0, 1919.5], [0, 1900, 1079.5], [0, 0, 1]]), "file")
    frame = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 0.0, 1.0)
    ends = np.array([line[1:] for line in lines], float)
    segments = Segments(project(ends, camera.matrix, frame.rotation), [line[0] for line in lines])
    found = FoundLines(camera, frame, segments, ())
    options = Options(collinear=False, reach=SHORT_REACH)
    made = reconstruct_lines("two houses.png", found, options)
    assert len(made.graph.segments) == len(lines)
    scene = made.scene
    part = np.repeat(np.arange(4), [len(part) for part in parts])
    middle = segments.ends.mean(axis=1)  # grouping brings the lines into another order
    order = np.linalg.norm(scene.lines.segment.mean(axis=1)[:, None] - middle, axis=2).argmin(axis=1)
    assert sorted(order.tolist()) == list(range(len(lines)))
    return SimpleNamespace(scene=scene, ends=ends[order], part=part[order])


def test_each_house_is_one_component(street):
    component = street.scene.lines.component
    assert [set(component[street.part == part].tolist()) for part in range(4)] == [{0}, {0}, {1}, {1}]


def test_each_house_has_its_true_shape(street):
    lines = street.scene.lines
    for component in range(2):
        own = lines.component == component
        ratio = lines.ends[own][:, :, X] / street.ends[own][:, :, X]
        np.testing.assert_allclose(ratio, ratio[0, 0], rtol=SHIFT)


def test_only_the_longer_storey_of_the_nearer_house_is_proven(street):
    words = [set(street.scene.lines.confidence[street.part == part].tolist()) for part in range(4)]
    assert sorted(words[:2], key=str) == [{"proven"}, {"supported"}]
    assert words[2:] == [{"weak"}, {"weak"}]


def test_no_crossing_is_called_real_between_storeys(street):
    crossings = street.scene.intersections
    rows = np.searchsorted(street.scene.lines.id, crossings.lines[crossings.real])
    assert (np.diff(street.part[rows], axis=1) == 0).all()


def test_crossings_of_a_tied_storey_stay_exact(street):
    crossings, lines = street.scene.intersections, street.scene.lines
    assert crossings.real.sum() >= 60
    for first, second in np.searchsorted(lines.id, crossings.lines[crossings.real]).tolist():
        third = 3 - int(lines.axis[first]) - int(lines.axis[second])
        assert lines.ends[first, 0, third] == lines.ends[second, 0, third]


def test_a_note_counts_what_was_tied(street):
    tied = int(((street.scene.lines.component == 0) & (street.scene.lines.confidence == "supported")).sum())
    assert any(note.startswith(f"{tied} lines of component 0") for note in street.scene.notes)
