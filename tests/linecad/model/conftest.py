"""A made photo: a house of two walls that meet in a corner, with windows, on a ground under a sky; trees as wanted.

The walls are x = 2 and y = 8, the ground z = -2, which no plane of lines is. The camera looks at the corner.

Behind it lines before a camera that looks along y, and the crossings between them.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from linecad.arrays import Float, Int
from linecad.geometry import central_camera, project, world_rays
from linecad.model.planes import find_planes
from linecad.model.regions.filling import Filled
from linecad.model.regions.find import Look, find_regions
from linecad.model.regions.surfaces import GroundOfFeet, Surface, find_surfaces, find_walls, likely_grounds
from linecad.scene import Camera, Intersections, Lines, Plane

WIDTH, HEIGHT, FOCAL = 960, 720, 800.0
TURN = 0.15  # rad
SIDE, FRONT, GROUND, TOP = 2.0, 8.0, -2.0, 1.6
FRONT_SPAN, SIDE_SPAN = (SIDE, 5.5), (FRONT, 16.0)
SKY, CLUTTER = 3, 4  # in the picture of the truth, after the side, the front and the ground


def rectangle(normal, place, u, v):
    """The four edges of a rectangle in the plane of `normal` at `place`, from u[0] to u[1] and from v[0] to v[1]."""
    across = [axis for axis in range(3) if axis != normal]
    edges = []
    for along, other, spans, places in ((0, 1, u, v), (1, 0, v, u)):
        for at in places:
            ends = np.full((2, 3), float(place))
            ends[:, across[along]], ends[:, across[other]] = spans, at
            edges.append((across[along], ends))
    return edges


def lines_of(edges, camera, rotation):
    """Lines, each edge once, and their planes, all in one component."""
    edges = list({(axis, ends.tobytes()): (axis, ends) for axis, ends in edges}.values())
    axis, ends = np.array([each[0] for each in edges], np.int64), np.array([each[1] for each in edges])
    count = len(axis)
    lines = Lines(
        id=np.arange(count), axis=axis, segment=project(ends, camera.matrix, rotation), ends=ends,
        is_boundary=np.zeros(count, bool), component=np.zeros(count, int), confidence=np.full(count, "proven"),
    )  # fmt: skip
    offset = ends[:, 0].copy()
    own = np.arange(3) == axis[:, None]
    offset[own] = np.nan
    shared = np.full((count, 3), -1)
    for number in range(3):
        rest = ~own[:, number]
        shared[rest, number] = np.unique(offset[rest, number], return_inverse=True)[1] + 1000 * number
    return lines, find_planes(offset, shared, lines.id)


@dataclass(frozen=True, eq=False)
class House:
    """The made photo with all that is known about it."""

    camera: Camera
    rotation: Float
    lines: Lines
    planes: tuple[Plane, ...]
    photo: NDArray[np.uint8]  # (H, W, 3) RGB
    truth: Int  # (H, W) what each pixel shows: the side, the front, the ground, SKY or CLUTTER
    trees: tuple[Float, ...]  # (V, 2) px, outlines

    def surfaces(self, feet: GroundOfFeet | None = None) -> list[Surface]:
        """What it is made of, on the likeliest ground."""
        walls = find_walls(self.planes, self.lines, self.camera)
        return find_surfaces(walls, likely_grounds(walls, self.lines, feet)[0], ceiling=None)


def build_house(trees=(), edges_too=()):
    """The house with red `trees`, each the outline (V, 2) px of what hides the rest, and with more lines."""
    camera = Camera(WIDTH, HEIGHT, central_camera(FOCAL, WIDTH, HEIGHT), "file")
    c, s = np.cos(TURN), np.sin(TURN)
    rotation = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    edges = rectangle(1, FRONT, FRONT_SPAN, (GROUND, TOP)) + rectangle(0, SIDE, SIDE_SPAN, (GROUND, TOP))
    for low in (-1.0, 0.4):
        edges += [
            each for left in (2.8, 4.2) for each in rectangle(1, FRONT, (left, left + 0.7), (low, low + 0.8))
        ]  # fmt: skip
        edges += [each for left in (9, 11, 13.5) for each in rectangle(0, SIDE, (left, left + 1), (low, low + 0.8))]
    lines, planes = lines_of([*edges, *edges_too], camera, rotation)
    truth = _truth(camera, rotation)
    photo = _painted(truth, lines)
    rng = np.random.default_rng(3)
    for tree in trees:
        mask = np.zeros(truth.shape, np.uint8)
        cv2.fillPoly(mask, [np.rint(tree).astype(np.int32)], 1)
        leaves = np.stack([rng.integers(*span, truth.shape) for span in ((90, 210), (50, 130), (10, 70))], axis=2)
        leaves = cv2.resize(leaves[::3, ::3].astype(np.uint8), truth.shape[::-1], interpolation=cv2.INTER_NEAREST)
        photo[mask > 0], truth[mask > 0] = leaves[mask > 0], CLUTTER
    return House(camera, rotation, lines, planes, photo, truth, tuple(np.asarray(tree, float) for tree in trees))


def _truth(camera, rotation):
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    rays = world_rays(np.stack([columns, rows], axis=2).astype(float), camera.matrix, rotation)
    truth, depth = np.full((HEIGHT, WIDTH), SKY), np.full((HEIGHT, WIDTH), np.inf)
    walls = ((0, SIDE, SIDE_SPAN, (GROUND, TOP)), (1, FRONT, FRONT_SPAN, (GROUND, TOP)), (2, GROUND, None, None))
    for number, (normal, place, u, v) in enumerate(walls):
        with np.errstate(divide="ignore", invalid="ignore"):
            met = place / rays[:, :, normal]
        inside = np.isfinite(met) & (met > 0) & (met < depth)
        if u is not None:
            points = rays * np.where(inside, met, 0)[:, :, None]
            inside &= (points[:, :, 1 - normal] > u[0]) & (points[:, :, 1 - normal] < u[1])
            inside &= (points[:, :, 2] > v[0]) & (points[:, :, 2] < v[1])
        truth[inside], depth[inside] = number, met[inside]
    return truth


def _painted(truth, lines):
    """The side and the front in two browns with dark lines, grey ground, blue sky, a little noise."""
    colours = np.array([[120, 90, 70], [200, 160, 130], [110, 110, 112], [120, 170, 235]])
    photo = np.clip(colours[truth] + np.random.default_rng(1).normal(0, 1.5, (*truth.shape, 3)), 0, 255)
    photo = np.ascontiguousarray(photo.astype(np.uint8))
    for start, end in np.rint(lines.segment).astype(int).tolist():
        cv2.line(photo, start, end, (60, 50, 45), 2, cv2.LINE_AA)
    return photo


@pytest.fixture(scope="session")
def house() -> House:
    return build_house()


@pytest.fixture(scope="session")
def house_regions(house) -> Filled:
    """What each part of the photo of the house shows."""
    return find_regions(house.planes, house.lines, house.camera, house.rotation, Look(house.photo, None, None))


@pytest.fixture(scope="session")
def make_house() -> Callable[..., House]:
    return build_house


@pytest.fixture(scope="session")
def to_lines() -> Callable[..., tuple[Lines, tuple[Plane, ...]]]:
    """A function of edges (axis, ends), camera and rotation."""
    return lines_of


CAMERA = Camera(3000, 2000, np.array([[2500.0, 0, 1499.5], [0, 2500, 999.5], [0, 0, 1]]), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # world to camera: x right, y forward, z up


def build_lines(rows, component=None):
    """Lines of rows (axis, start point, end point)."""
    ends = np.array([row[1:] for row in rows], float).reshape(-1, 2, 3)
    count = len(rows)
    return Lines(
        id=np.arange(count), axis=[row[0] for row in rows], segment=project(ends, CAMERA.matrix, AHEAD), ends=ends,
        is_boundary=np.zeros(count, bool), component=np.zeros(count, int) if component is None else component,
        confidence=np.full(count, "proven"),
    )  # fmt: skip


def build_crossings(pairs, kind="T", real=True, reason="", in_tree=False):
    count = len(pairs)
    return Intersections(
        lines=np.array(pairs, int).reshape(-1, 2), kind=np.full(count, kind), pixel=np.zeros((count, 2)),
        real=np.full(count, real), in_tree=np.full(count, in_tree), weight=np.ones(count),
        reason=np.full(count, reason),
    )  # fmt: skip


def build_photo(rows, step=40):
    """A grey photo (H, W) with a step of brightness of 15 px beside rows (axis, start, end), level or upright in it."""
    grey = np.full((CAMERA.height, CAMERA.width), 100.0, np.float32)
    for _, start, end in rows:
        (x0, y0), (x1, y1) = project(np.array([start, end], float), CAMERA.matrix, AHEAD)
        is_level = abs(y1 - y0) < abs(x1 - x0)
        picture = grey if is_level else grey.T
        (low, high), at = (sorted([x0, x1]), y0) if is_level else (sorted([y0, y1]), x0)
        low, high, at = (max(0, round(each + 0.5)) for each in (low, high, at))
        picture[at : at + 15, low:high] += step
    return grey


@pytest.fixture
def photo():
    return build_photo


@pytest.fixture
def crossings():
    return build_crossings


@pytest.fixture
def lines():
    return build_lines


@pytest.fixture(scope="session")
def camera():
    return CAMERA


@pytest.fixture(scope="session")
def rotation():
    return AHEAD
