"""A made scene: two boxes with a grid of edges on two faces each, seen by a known camera."""

import zlib
from dataclasses import dataclass, replace

import cv2
import numpy as np
import pytest

import linecad.camera.distortion
from linecad.arrays import Float, Int
from linecad.geometry import project
from linecad.graph.build import build_line_graph
from linecad.line_graph import ManhattanFrame, Segments
from linecad.options import SHORT_REACH
from linecad.scene import Camera

WIDTH, HEIGHT, FOCAL = 1600, 1200, 900.0
YAW, PITCH, ROLL = 0.15, -0.10, 0.02  # rad

# Each face of a box: its normal, where it stands, and the grid of edges in the two other coordinates. The origin is
# the camera's eye. The front and the side of a box meet in one vertical edge and share the heights of their courses.
HIGH, LOW = [-1.6, 0.4, 1.5, 2.9, 3.8], [-1.5, -0.3, 0.9, 2.2]  # units
BOXES = [
    [(1, 9.0, [-5.4, -4.4, -3.2, -2.2], HIGH), (0, -2.2, [9.0, 10.4, 12.5, 16.0], HIGH)],
    [(1, 7.0, [2.6, 3.5, 4.4, 5.6], LOW), (0, 2.6, [7.0, 8.6, 11.0], LOW)],
]


@pytest.fixture(scope="session", autouse=True)
def bends_found_once():
    """The bend of one photo is looked for once for all tests of a process: most of them open the same samples."""
    find_bend, known = linecad.camera.distortion.find_bend, {}

    def remember(photo):
        key = (zlib.crc32(photo.pixels), repr(photo))
        if key not in known:
            known[key] = find_bend(photo)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(linecad.camera.distortion, "find_bend", remember)
        yield


@dataclass(frozen=True)
class MadeScene:
    """True lines in space with everything that follows from them."""

    camera: Camera
    frame: ManhattanFrame
    axis: Int  # (N,)
    ends: Float  # (N, 2, 3) world
    box: Int  # (N,) which of the two boxes
    pixels: Float  # (N, 2, 2) px

    @property
    def segments(self):
        """The exact segments with their true labels."""
        return Segments(self.pixels, self.axis)

    @property
    def unlabelled(self):
        return Segments(self.pixels, np.full(len(self.axis), -1))

    def noisy(self, sigma, seed=0):
        """Unlabelled segments whose ends are off by `sigma` px in x and y."""
        noise = np.random.default_rng(seed).normal(0, sigma, self.pixels.shape)
        return Segments(self.pixels + noise, np.full(len(self.axis), -1))

    def depth_at(self, line, pixel):
        """Camera depth of a true line where it is seen at (or nearest to) a pixel."""
        return depth_on_axis_line(self.camera, self.frame.rotation, self.axis[line], self.ends[line, 0], pixel)

    def graph(self, extension=30.0):
        return build_line_graph(self.segments, self.camera, self.frame, replace(SHORT_REACH, extension=extension))

    def truly_real(self, graph):
        """Mask (E,) of the crossings whose two true lines meet in space; for graphs of all the exact segments."""
        i, j = graph.edges.T
        apart = self.ends[i, 0, graph.coordinate] - self.ends[j, 0, graph.coordinate]
        return np.abs(apart) < 1e-9

    def image(self):
        """The boxes drawn with a random grey for each cell between edges, on a light ground."""
        rng = np.random.default_rng(5)
        image = np.full((HEIGHT, WIDTH), 235, np.uint8)
        for box in BOXES:
            for normal, place, across, up in box:
                for i in range(len(across) - 1):
                    for j in range(len(up) - 1):
                        ring = [(across[i + a], up[j + b]) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                        corners = np.insert(np.array(ring), normal, place, axis=1)
                        points = np.round(project(corners, self.camera.matrix, self.frame.rotation) * 16).astype(int)
                        # Neighbours differ by 40 grey levels at least, like a chessboard, so that each edge shows.
                        grey = (70 if (i + j + normal) % 2 else 150) + int(rng.integers(0, 40))
                        cv2.fillPoly(image, [points], grey, cv2.LINE_AA, shift=4)
        noise = rng.normal(0, 2, image.shape)
        return np.clip(image + noise, 0, 255).astype(np.uint8)


def depth_on_axis_line(camera, rotation, axis, point, pixel):
    """Depth s at which the ray of a pixel comes nearest to the line of `axis` through `point`, by least squares."""
    ray = rotation.T @ np.linalg.inv(camera.matrix) @ np.array([*pixel, 1.0])
    across = [other for other in range(3) if other != axis]
    return float(ray[across] @ np.asarray(point)[across] / (ray[across] @ ray[across]))


def camera_rotation(yaw, pitch, roll):
    """World (x right, y away, z up) to camera (x right, y down, z forward)."""
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    base = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    c, s = np.cos(pitch), np.sin(pitch)
    nod = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    c, s = np.cos(roll), np.sin(roll)
    lean = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return lean @ nod @ base @ turn


def build_lines():
    """Axis, ends and box of every grid line; an edge that two faces share stands once."""
    lines = {}
    for number, box in enumerate(BOXES):
        for normal, place, across, up in box:
            other = 1 - normal
            for x in across:
                low, high = np.empty(3), np.empty(3)
                low[[normal, other, 2]], high[[normal, other, 2]] = (place, x, up[0]), (place, x, up[-1])
                lines[*low, *high] = (2, number)
            for z in up:
                low, high = np.empty(3), np.empty(3)
                low[[normal, other, 2]], high[[normal, other, 2]] = (place, across[0], z), (place, across[-1], z)
                lines[*low, *high] = (other, number)
    ends = np.array(list(lines)).reshape(-1, 2, 3)
    axis, box = np.array(list(lines.values())).T
    return axis, ends, box


@pytest.fixture(scope="session")
def made():
    rotation = camera_rotation(YAW, PITCH, ROLL)
    matrix = np.array([[FOCAL, 0, (WIDTH - 1) / 2], [0, FOCAL, (HEIGHT - 1) / 2], [0, 0, 1]])
    axis, ends, box = build_lines()
    pixels = project(ends, matrix, rotation)
    assert (ends @ rotation.T)[..., 2].min() > 1
    assert pixels.min() > 0
    assert (pixels < [WIDTH, HEIGHT]).all()
    frame = ManhattanFrame(rotation, 0.0, 1.0)
    return MadeScene(Camera(WIDTH, HEIGHT, matrix, "file"), frame, axis, ends, box, pixels)


@pytest.fixture(scope="session")
def depth_on():
    return depth_on_axis_line
