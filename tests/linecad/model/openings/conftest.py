"""A plastered facade with windows, painted: its photo, its plane, and lines for as many windows as a test asks for."""

from dataclasses import dataclass, field

import cv2
import numpy as np
import pytest

from linecad.geometry import project
from linecad.model.openings.find import FrameView, find_openings, look_at_walls
from linecad.scene import Camera, Lines, Plane

CAMERA = Camera(1200, 900, np.array([[900.0, 0, 599.5], [0, 900, 449.5], [0, 0, 1]]), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
DISTANCE = 10.0
WALL, GLASS, FRAME = (190, 180, 165), (50, 60, 70), (235, 235, 230)
WIDE, TALL = 1.0, 1.5
COLUMNS, ROWS = (-4.0, -1.7, 0.6, 2.9), (-1.2, 1.4)  # lower left corners
FOOT, EAVES = -2.0, 3.8


@dataclass(frozen=True)
class Facade:
    """A painted facade."""

    pixels: np.ndarray  # (900, 1200, 3)
    planes: tuple[Plane, ...]
    lines: Lines
    boxes: list[tuple[float, float, float, float]]  # u0, u1, v0, v1 of the true windows
    camera: Camera = CAMERA
    rotation: np.ndarray = field(default_factory=AHEAD.copy)

    def openings(self, pixels=None):
        """What is found in its photo, or in another."""
        seen = self.pixels if pixels is None else pixels
        return find_openings(
            look_at_walls([self.view()], self.camera, seen), self.planes, self.camera, self.rotation
        ).openings

    def view(self, planes=None):
        """How it is seen, or other planes than its own."""
        return FrameView(self.planes if planes is None else planes, self.lines, self.rotation, 0)


def paint(pixels, u0, u1, v0, v1, colour):
    """Fill a rectangle of the wall."""
    ring = np.array([[u0, DISTANCE, v0], [u1, DISTANCE, v0], [u1, DISTANCE, v1], [u0, DISTANCE, v1]])
    corners = np.rint(16 * project(ring, CAMERA.matrix, AHEAD)).astype(np.int32)
    cv2.fillPoly(pixels, [corners], colour, cv2.LINE_AA, shift=4)


def edges_of(u0, u1, v0, v1, distance=DISTANCE):
    """The four sides of a rectangle in a wall as (axis, ends)."""
    corner = {(i, j): [u, distance, v] for i, u in enumerate((u0, u1)) for j, v in enumerate((v0, v1))}
    return [
        *((0, np.array([corner[0, j], corner[1, j]], float)) for j in (0, 1)),
        *((2, np.array([corner[i, 0], corner[i, 1]], float)) for i in (0, 1)),
    ]


def lines_of(edges):
    """Lines in space, all of component 0."""
    ends = np.array([each[1] for each in edges])
    count = len(edges)
    return Lines(
        id=np.arange(count), axis=np.array([each[0] for each in edges]), segment=project(ends, CAMERA.matrix, AHEAD),
        ends=ends, is_boundary=np.zeros(count, bool), component=np.zeros(count, int),
        confidence=np.full(count, "supported"),
    )  # fmt: skip


def make_facade(hidden=(), with_lines=None, half_hidden=()):
    """Windows at every column and row, the first `with_lines` with lines.

    Those in `hidden` are behind a tree; of those in `half_hidden` the lower half shows the wall.
    """
    pixels = np.full((900, 1200, 3), (215, 225, 240), np.uint8)
    paint(pixels, -6, 6, FOOT, EAVES, WALL)
    boxes = [(u, u + WIDE, v, v + TALL) for v in ROWS for u in COLUMNS]
    for u0, u1, v0, v1 in boxes:
        paint(pixels, u0, u1, v0, v1, FRAME)
        paint(pixels, u0 + 0.08, u1 - 0.08, v0 + 0.08, v1 - 0.08, GLASS)
        paint(pixels, (u0 + u1) / 2 - 0.03, (u0 + u1) / 2 + 0.03, v0, v1, FRAME)
    rng = np.random.default_rng(5)
    for number in hidden:
        u0, u1, v0, v1 = boxes[number]
        for _ in range(400):
            u, v = rng.uniform(u0 - 0.2, u1 + 0.2), rng.uniform(v0 - 0.2, v1 + 0.2)
            colour = tuple(int(shade) for shade in rng.integers(40, 110, 3) * [0.7, 1.2, 0.5])
            paint(pixels, u, u + 0.12, v, v + 0.1, colour)
    for number in half_hidden:
        u0, u1, v0, v1 = boxes[number]
        paint(pixels, u0 - 0.3, u1 + 0.3, v0 - 0.3, (v0 + v1) / 2, WALL)
    edges = edges_of(-6, 6, FOOT, EAVES)
    for box in boxes[:with_lines]:
        edges += edges_of(*box)
    lines = lines_of(edges)
    return Facade(pixels, (Plane(7, 1, DISTANCE, tuple(lines.id.tolist())),), lines, boxes)


@pytest.fixture(scope="session")
def facade():
    """All windows in sight, each with its lines."""
    return make_facade()


@pytest.fixture(scope="session")
def facade_of():
    """How facades are made."""
    return make_facade


@pytest.fixture(scope="session")
def sides():
    """How the sides of rectangles, and lines of them, are made."""
    return edges_of, lines_of


@pytest.fixture(scope="session")
def painted():
    """How rectangles of the wall are filled."""
    return paint
