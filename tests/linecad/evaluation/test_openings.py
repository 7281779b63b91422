"""Windows against true ones: right, false, missed, and those about which nothing can be said."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.dataset.truth import NOTHING, TrueOpenings, Truth
from linecad.evaluation.openings import score_openings, windows_f1
from linecad.geometry import project
from linecad.scene import Camera, Intersections, Lines, Opening, Plane, Scene, SolveReport

CAMERA = Camera(640, 480, np.array([[500.0, 0, 319.5], [0, 500, 239.5], [0, 0, 1]]), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
DISTANCE = 10.0
SCALE = 2.0  # units a metre
WINDOWS = [(-3.0, -2.0, 0.0, 1.5), (0.0, 1.0, 0.0, 1.5), (3.0, 4.0, 0.0, 1.5)]
DOOR = (-1.5, -0.5, -2.0, 0.5)


def ring(u0, u1, v0, v1, distance=DISTANCE):
    return np.array([[u0, distance, v0], [u1, distance, v0], [u1, distance, v1], [u0, distance, v1]])


@pytest.fixture
def truth():
    boxes = [*WINDOWS, DOOR]
    count = len(boxes)
    return Truth(
        name="wall", width=640, height=480, matrix=CAMERA.matrix, rotation=AHEAD,
        quads=np.array([ring(-6, 6, -4, 4), ring(2.8, 4.2, -1, 2, 5.0) * [0.5, 1, 0.5]]), body=np.array([0, 1]),
        edges=np.zeros((0, 2, 3)), edge_body=np.zeros(0, np.int64), pieces=np.zeros((0, 2, 2)),
        piece_edge=np.zeros(0, np.int64), ids=np.zeros((480, 640), np.int64),
        openings=TrueOpenings(
            np.array([ring(*box) for box in boxes]), np.arange(count) == count - 1, np.zeros(count, np.int64)
        ),
    )  # fmt: skip


def scene_of(boxes, lines=8, others=0):
    """Openings at boxes in metres, in a scene of another scale, with lines on the wall, the last ones `others`."""
    starts = np.column_stack([np.linspace(-4, 4, lines), np.full(lines, DISTANCE), np.zeros(lines)])
    ends = np.stack([starts, starts + np.array([0, 0, 1.0])], axis=1)
    return Scene(
        photo="wall.jpg", camera=CAMERA, rotation=AHEAD,
        lines=Lines(np.arange(lines), np.full(lines, 2), project(ends, CAMERA.matrix, AHEAD), SCALE * ends,
                    np.zeros(lines, bool), np.arange(lines) >= lines - others, np.full(lines, "supported")),
        intersections=Intersections(np.zeros((0, 2)), (), np.zeros((0, 2)), (), (), ()),
        planes=(Plane(4, 1, SCALE * DISTANCE, tuple(range(lines))),), solve=SolveReport("", "", "", 0.0, 0.0, 0.0),
        openings=tuple(
            Opening(number, 4, *(SCALE * np.array(box)).tolist(), kind=kind) for number, (box, kind) in enumerate(boxes)
        ),
    )  # fmt: skip


def windows(*boxes):
    return [(box, "window") for box in boxes]


def counts(scene, truth, kind="window", everywhere=False):
    found = score_openings(scene, truth, kind, everywhere)
    return found.right, found.found, found.true


def test_all_windows_found_is_one(truth):
    scene = scene_of([*windows(*WINDOWS), (DOOR, "door")])
    assert counts(scene, truth) == (3, 3, 3)
    assert windows_f1(scene, truth) == 1.0
    assert counts(scene, truth, "door") == (1, 1, 1)


def test_missed_and_false_ones_count(truth):
    scene = scene_of(windows(WINDOWS[0], (1.5, 2.5, 0.0, 1.5)))
    assert counts(scene, truth) == (1, 2, 3)
    assert windows_f1(scene, truth) == pytest.approx(2 / 5)


def test_half_a_window_is_none_and_two_thirds_are_one(truth):
    u0, u1, v0, v1 = WINDOWS[0]
    assert counts(scene_of(windows((u0, u1, v0, v0 + 0.45 * (v1 - v0)))), truth)[0] == 0
    assert counts(scene_of(windows((u0, u1, v0, v0 + 0.67 * (v1 - v0)))), truth)[0] == 1


def test_window_found_twice_counts_once_right_and_once_false(truth):
    u0, u1, v0, v1 = WINDOWS[0]
    assert counts(scene_of(windows(WINDOWS[0], (u0, u1, v0, v1 - 0.2))), truth) == (1, 2, 3)


def test_hidden_window_counts_neither_way(truth):
    ids = truth.ids.copy()
    left, top = np.floor(project(ring(*WINDOWS[2]), CAMERA.matrix, AHEAD).min(axis=0)).astype(int)
    right, bottom = np.ceil(project(ring(*WINDOWS[2]), CAMERA.matrix, AHEAD).max(axis=0)).astype(int)
    ids[top : bottom + 1, left : right + 1] = 1
    hidden = replace(truth, ids=ids)
    assert counts(scene_of(windows(*WINDOWS)), hidden) == (2, 2, 2)
    assert counts(scene_of(windows(*WINDOWS[:2])), hidden) == (2, 2, 2)


def test_facade_without_lines_of_component_0_does_not_count(truth):
    assert counts(scene_of(windows(*WINDOWS), lines=3), truth) == (0, 0, 0)
    assert windows_f1(scene_of(windows(WINDOWS[0], (1.5, 2.5, 0.0, 1.5)), lines=3), truth) is None


def test_facade_that_other_components_show_more_of_does_not_count(truth):
    half = scene_of(windows(WINDOWS[0], (1.5, 2.5, 0.0, 1.5)), lines=12, others=6)
    assert counts(half, truth) == (1, 2, 3)
    less = scene_of(windows(WINDOWS[0], (1.5, 2.5, 0.0, 1.5)), lines=13, others=7)
    assert counts(less, truth) == (0, 0, 0)
    assert counts(less, truth, everywhere=True) == (1, 2, 3)
    assert windows_f1(less, truth, everywhere=True) == pytest.approx(2 / 5)


@pytest.mark.parametrize("lines", [(), (6, 7), (0, 6, 7)])
def test_opening_on_a_plane_of_another_component_is_not_found(truth, lines):
    scene = scene_of(windows(*WINDOWS), others=2)
    moved = replace(scene, planes=(*scene.planes, Plane(5, 1, SCALE * DISTANCE, lines)))
    moved = replace(moved, openings=tuple(replace(each, plane=4 + (each.id == 1)) for each in scene.openings))
    assert counts(moved, truth) == (2, 2, 3)
    assert counts(moved, truth, everywhere=True) == (3, 3, 3)
    whole = replace(moved, planes=(scene.planes[0], replace(moved.planes[1], lines=(0, 7))))
    assert counts(whole, truth) == (3, 3, 3)


def test_window_in_the_sky_is_false(truth):
    ids = truth.ids.copy()
    ids[:60] = NOTHING
    assert counts(scene_of(windows((-1.0, 1.0, 4.0, 4.5))), replace(truth, ids=ids)) == (0, 1, 3)


def test_window_outside_the_photo_does_not_count(truth):
    known = truth.openings
    away = replace(known, corners=known.corners + np.array([20.0, 0, 0]))
    assert counts(scene_of([]), replace(truth, openings=away)) == (0, 0, 0)


def test_truth_that_tells_no_openings_scores_nothing(truth):
    assert score_openings(scene_of(windows(*WINDOWS)), replace(truth, openings=None), "window") is None
    assert windows_f1(scene_of(windows(*WINDOWS)), replace(truth, openings=None)) is None
