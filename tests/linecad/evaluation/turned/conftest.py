"""A scene of two walls, the ground, a hole and lines, with a photo of stripes on it, and the GLB of it."""

import numpy as np
import pytest

from linecad.evaluation.turned.glb import read_glb
from linecad.geometry import project
from linecad.outputs import write_outputs
from linecad.scene import Camera, Face, Intersections, Lines, Plane, Scene, SolveReport

CAMERA = Camera(320, 240, [[260.0, 0, 150.0], [0, 260.0, 125.0], [0, 0, 1]], "file")
TURN, PITCH = 0.3, 0.1
FRONT = [(-4.0, 10, -1.5), (3, 10, -1.5), (3, 10, 3), (-4, 10, 3)]
HOLE = [(-1.0, 10, 0), (0.5, 10, 0), (0.5, 10, 1), (-1, 10, 1)]
SIDE = [(3.0, 6, -1.5), (3, 10, -1.5), (3, 10, 3), (3, 6, 3)]
GROUND = [(-4.0, 4, -1.5), (3, 4, -1.5), (3, 10, -1.5), (-4, 10, -1.5)]
ENDS = np.array([[(-4.0, 10, 3), (3, 10, 3)], [(-2, 14, -1), (-2, 14, 2)], [(3, 10, -1.5), (3, 10, 3)]])


def rotation():
    """World to camera: turned to the right, and upwards."""
    level = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    c, s = np.cos(TURN), np.sin(TURN)
    turned = level @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    c, s = np.cos(PITCH), np.sin(PITCH)
    return np.array([[1, 0, 0], [0, c, s], [0, -s, c]]) @ turned


@pytest.fixture(scope="session")
def scene():
    faces = [(1, 10.0, FRONT, HOLE), (0, 3.0, SIDE), (2, -1.5, GROUND)]
    planes = tuple(
        Plane(number, axis, offset, (), (Face(number, np.array(outline), tuple(map(np.array, holes))),))
        for number, (axis, offset, outline, *holes) in enumerate(faces)
    )
    lines = Lines(
        [0, 1, 2], [0, 2, 2], project(ENDS, CAMERA.matrix, rotation()), ENDS, [True, False, True], [0] * 3,
        ["proven"] * 3,
    )  # fmt: skip
    nothing = Intersections(np.zeros((0, 2)), [], np.zeros((0, 2)), [], [], [])
    solve = SolveReport("none", "gain", "optimal", 0.0, 0.0, 0.0)
    return Scene("a.png", CAMERA, rotation(), lines, nothing, planes, solve)


@pytest.fixture(scope="session")
def photo():
    """A photo (240, 320, 3) that no two places have alike, and that changes slowly."""
    y, x = np.mgrid[:240, :320]
    return np.stack([40 + x // 2, 40 + y // 2, 120 + 60 * np.sin(x / 20) * np.sin(y / 20)], axis=-1).astype(np.uint8)


@pytest.fixture(scope="session")
def glb(scene, photo, tmp_path_factory):
    """A function from whether the faces have the photo on them to the path of a GLB."""

    def write(textured=True):
        path = tmp_path_factory.mktemp("glb") / "a.glb"
        write_outputs(scene, photo if textured else None, [path], {})
        return path

    return write


@pytest.fixture(scope="session")
def model(glb):
    return read_glb(glb())
