"""Small scenes drawn by hand, before a level camera that looks along y."""

import numpy as np
import pytest

from linecad.evaluation.draughting.shapes import shapes_of
from linecad.geometry import project
from linecad.scene import Camera, Face, Intersections, Lines, Plane, Scene, SolveReport

LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # world to camera
CAMERA = Camera(960, 640, [[600.0, 0, 479.5], [0, 600.0, 319.5], [0, 0, 1]], "file")


def build_scene(lines=(), faces=(), components=None):
    """A scene of lines, each (start, end), and faces, each (axis, offset, outline, hole ...) in their planes."""
    ends = np.array(lines, float).reshape(-1, 2, 3)
    count = len(ends)
    planes = []
    for number, (axis, offset, *rings) in enumerate(faces):
        world = [np.insert(np.array(ring, float), axis, offset, axis=1) for ring in rings]
        planes.append(Plane(number, axis, offset, (), (Face(number, world[0], tuple(world[1:])),)))
    return Scene(
        "a.jpg", CAMERA, LEVEL,
        Lines(
            range(count), np.abs(ends[:, 1] - ends[:, 0]).argmax(axis=1), project(ends, CAMERA.matrix, LEVEL), ends,
            [False] * count, [0] * count if components is None else components, ["proven"] * count,
        ),
        Intersections(np.zeros((0, 2)), [], np.zeros((0, 2)), [], [], []), tuple(planes),
        SolveReport("none", "gain", "optimal", 0.0, 0.0, 0.0),
    )  # fmt: skip


def box(low, high):
    """Corners of a rectangle."""
    (a, b), (c, d) = low, high
    return [(a, b), (c, b), (c, d), (a, d)]


@pytest.fixture(scope="session")
def drawing():
    """A function from lines and faces to a scene and its shapes."""

    def build(lines=(), faces=(), components=None):
        scene = build_scene(lines, faces, components)
        return scene, shapes_of(scene)

    return build


@pytest.fixture(scope="session")
def rectangle():
    """A function from two opposite corners to an outline."""
    return box
