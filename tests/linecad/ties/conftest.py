"""Walls of grids before a camera: exact lines, their graph, their true depths, bodies made of them, and photos."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from linecad.arrays import Float, Int
from linecad.decide.stability import Fits
from linecad.depth.depth_map import DepthMap
from linecad.geometry import central_camera, project, rotation_about, world_rays
from linecad.graph.build import build_line_graph
from linecad.line_graph import LineGraph, ManhattanFrame, Segments
from linecad.options import LONG_REACH
from linecad.scene import Camera
from linecad.ties.bodies import RigidBodies
from linecad.ties.setting import Setting, Sight

WIDTH, HEIGHT, FOCAL = 3840, 2880, 3000.0
CAMERA = Camera(WIDTH, HEIGHT, central_camera(FOCAL, WIDTH, HEIGHT), "file")
SMALL = Camera(WIDTH // 4, HEIGHT // 4, central_camera(FOCAL / 4, WIDTH // 4, HEIGHT // 4), "file")
FRONTAL = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 0.0, 1.0)  # x right, y away, z up
FITS = 4


@dataclass(frozen=True, eq=False)
class Town:
    """Parts of lines, each (axis, point, other end), that the camera sees."""

    graph: LineGraph
    sight: Sight  # without pixels, unless it is painted
    log_depth: Float  # (N,) true, of the middle of each segment
    part: Int  # (N,)


def wall(normal, place, across, heights):
    """Uprights and courses of a grid in the vertical plane where coordinate `normal` is `place`."""
    other = 1 - normal
    lines = []
    for at in across:
        ends = np.empty((2, 3))
        ends[:, normal], ends[:, other], ends[:, 2] = place, at, (heights[0], heights[-1])
        lines.append((2, *ends))
    for height in heights:
        ends = np.empty((2, 3))
        ends[:, normal], ends[:, other], ends[:, 2] = place, (across[0], across[-1]), height
        lines.append((other, *ends))
    return lines


def town(*parts, collinear=True, yaw=0.0, pitch=0.0, camera=CAMERA):
    """What the camera sees of parts; every line must be long enough to be seen.

    The camera is turned to the right by `yaw` and then up by `pitch` (rad).
    """
    lines = [line for part in parts for line in part]
    axis = np.array([line[0] for line in lines])
    ends = np.array([line[1:] for line in lines], float)
    level = FRONTAL.rotation @ rotation_about(np.array([0.0, 0.0, yaw]))
    rotation = rotation_about(np.array([-pitch, 0.0, 0.0])) @ level
    pixels = project(ends, camera.matrix, rotation)
    assert ends[..., 1].min() > 1
    assert pixels.min() > 0
    assert (pixels < [camera.width, camera.height]).all()
    frame = ManhattanFrame(rotation, 0.0, 1.0)
    graph = build_line_graph(Segments(pixels, axis), camera, frame, LONG_REACH, "odds", collinear)
    assert len(graph.segments) == len(lines)
    # The ray of a middle has depth 1; across its axis it is the line's own coordinate over the depth.
    fixed = np.where(axis == 1, np.where(np.abs(graph.rays[:, 0]) > np.abs(graph.rays[:, 2]), 0, 2), 1)
    at = np.arange(len(lines))
    log_depth = np.log(ends[at, 0, fixed] / graph.rays[at, fixed])
    part = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    return Town(graph, Sight(camera.matrix, rotation, camera.width, None), log_depth, part)


SKY = (205, 220, 240)


@dataclass(frozen=True)
class Surface:
    """A part of a plane in space, and its colour (..., 3) at points (..., 3) of it."""

    normal: int
    place: float
    low: tuple[float, float, float]  # the coordinate `normal` does not count
    high: tuple[float, float, float]
    colour: Callable[[Float], Float] | None


def facade(normal, place, across, heights, colour=None):
    """The wall between two places across and two heights; without a colour where nobody paints it."""
    low, high = np.full(3, place), np.full(3, place)
    low[[1 - normal, 2]], high[[1 - normal, 2]] = (across[0], heights[0]), (across[1], heights[1])
    return Surface(normal, place, tuple(low), tuple(high), colour)


def ground(below, colour):
    """The ground so far below the camera."""
    return Surface(2, -below, (-np.inf,) * 3, (np.inf,) * 3, colour)


def mottled(colour, amount, seed, cell=0.08):
    """A colour with grain: cells in space, each a bit lighter or darker."""
    grain = np.random.default_rng(seed).normal(0, amount, (32, 32, 32, 1))

    def at(points):
        i, j, k = np.moveaxis(np.floor(points / cell).astype(int) % 32, -1, 0)
        return np.asarray(colour) + grain[i, j, k]

    return at


def paint(sight, surfaces, block=4):
    """The pixels (H, W, 3) of a camera before surfaces, in squares of `block` px that have one colour."""
    width, height = sight.width // block, round(sight.width * HEIGHT / WIDTH) // block
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    rays = world_rays(np.stack([u, v], axis=-1) * block + (block - 1) / 2, sight.matrix, sight.rotation)
    seen, nearest = np.empty((height, width, 3)), np.full((height, width), np.inf)
    seen[:] = SKY
    for surface in surfaces:
        with np.errstate(divide="ignore"):
            depth = surface.place / rays[..., surface.normal]
        before = (depth > 0) & (depth < nearest)
        points = rays * np.where(before, depth, 1.0)[..., None]
        inside = (points >= surface.low) & (points <= surface.high)
        inside[..., surface.normal] = True
        shown = before & inside.all(axis=-1)
        seen[shown], nearest[shown] = surface.colour(points[shown]), depth[shown]
    small = np.clip(np.rint(seen), 0, 255).astype(np.uint8)
    return small.repeat(block, axis=0).repeat(block, axis=1)


def depth_map(sight, surfaces, kind="z", scale=1.0, shift=0.0, told=True):
    """The exact map of what a camera sees of surfaces, all `scale` times as far; no depth where there is none.

    To the map of kind affine-inverse `shift` is added, as a share of its largest number.
    """
    turned = np.linalg.inv(sight.matrix @ sight.rotation)
    u, v = np.arange(sight.width), np.arange(sight.width * HEIGHT // WIDTH)[:, None]
    rays = [row[0] * u + row[1] * v + row[2] for row in turned]
    depth = np.full(rays[0].shape, np.inf)
    for surface in surfaces:
        with np.errstate(divide="ignore"):
            found = surface.place / rays[surface.normal]
        shown = (found > 0) & (found < depth)
        for axis in {0, 1, 2} - {surface.normal}:
            with np.errstate(invalid="ignore"):
                at = rays[axis] * found
            shown &= (at >= surface.low[axis]) & (at <= surface.high[axis])
        depth[shown] = found[shown]
    depth *= scale
    values = {"z": depth, "distance": depth * np.sqrt(sum(ray**2 for ray in rays))}.get(kind, 1 / depth)
    valid = np.isfinite(depth)
    values = values + shift * values[valid].max()
    return DepthMap("map.npz", np.where(valid, values, 0), valid, kind if told else None)


def avenue():
    """Two walls along the way and one across its end, and their surfaces; nothing but a map tells how they stand."""
    heights = [np.array([-2.2, -1.3, 0.1, 0.9, 2.0]), np.array([-1.9, -0.7, 0.4, 1.6]), np.array([-2.5, 0.2, 1.2, 3.1])]
    sides = [(-3.0, np.arange(8.0, 16.1, 0.9)), (2.6, np.arange(9.0, 18.1, 1.0))]
    parts = [wall(0, place, away, high) for (place, away), high in zip(sides, heights, strict=False)]
    parts.append(wall(1, 26.0, np.arange(-1.5, 1.6, 0.43), heights[2]))
    surfaces = [
        facade(0, -3.0, (7.6, 16.6), (-2.7, 2.5)),
        facade(0, 2.6, (8.6, 18.6), (-2.4, 2.1)),
        facade(1, 26.0, (-2.2, 2.2), (-3.2, 3.8)),
    ]
    return town(*parts, yaw=0.04, pitch=0.02, camera=SMALL), surfaces


CAMERA_HEIGHT = 1.6  # m above the pavement of `lane`


def lane():
    """Two brick walls with windows on a pale pavement, across and along the way; nothing else tells how they stand."""
    brick, pane = mottled((150, 80, 60), 9, 1), np.array([40, 45, 55])

    def windowed(start, axis):
        def colour(points):
            along, height = (points[..., axis] - start) % 1.6, (points[..., 2] + CAMERA_HEIGHT) % 1.7
            is_pane = (along > 0.5) & (along < 1.2) & (height > 0.7) & (height < 1.4)
            return np.where(is_pane[..., None], pane, brick(points))

        return colour

    first = wall(1, 9.0, np.arange(-3.5, 0.0, 0.4), np.array([-0.9, -0.2, 0.8, 1.5, 2.4]))
    second = wall(0, 2.5, np.arange(9.0, 15.0, 0.6), np.array([-0.77, 0.13, 1.02, 1.67]))
    seen = town(first, second, yaw=0.05, pitch=0.03)
    surfaces = [
        facade(1, 9.0, (-4.0, 0.0), (-CAMERA_HEIGHT, 3.0), windowed(-4.0, 0)),
        facade(0, 2.5, (8.5, 15.0), (-CAMERA_HEIGHT, 3.0), windowed(8.5, 1)),
        ground(CAMERA_HEIGHT, mottled((140, 140, 135), 14, 3)),
    ]
    return replace(seen, sight=replace(seen.sight, pixels=paint(seen.sight, surfaces)))


def still(count, group):
    """Fits in which every line is seen and nothing moves."""
    seen = np.ones((FITS, count), bool)
    return Fits(seen, np.zeros((FITS, count)), np.tile(np.asarray(group), (FITS, 1)))


def setting(seen, moved=(), body=None, fits=None, pixels=None):
    """The parts of a town as bodies, their depths moved by so much each; the fits as they are found, unconnected."""
    body = seen.part if body is None else np.asarray(body)
    count = int(body.max(initial=-1)) + 1
    by = np.zeros(count)
    by[: len(moved)] = moved
    log_depth = seen.log_depth + np.where(body >= 0, by[np.maximum(body, 0)], 0.0)
    if fits is None:
        fits = still(len(body), body + 1)
        fits = replace(fits, depth=np.tile(log_depth, (FITS, 1)))
    return Setting(seen.graph, log_depth, RigidBodies(body, count), fits, replace(seen.sight, pixels=pixels))


def row(bars, at=(10.0, 10.0), level=False, end=4.0):
    """Two walls of 24 lines each, one beside the other too far to touch; so many courses of the first reach the second.

    `at` is how far away they stand, `end` where these courses end before the second. If `level`, the courses of both
    have the same heights.
    """
    random = np.random.default_rng(7)
    heights, others = (np.linspace(-3.0, 3.0, 12) + random.uniform(-0.2, 0.2, 12) for _ in range(2))
    first = wall(1, at[0], np.linspace(-5.5, -1.2, 12), heights)
    for _, _, far in first[15 : 15 + bars]:
        far[0] = end * at[0] / at[1]
    return first, wall(1, at[1], np.linspace(0.8, 5.0, 12), heights if level else others)


@pytest.fixture(scope="session")
def build_wall():
    return wall


@pytest.fixture(scope="session")
def build_town():
    return town


@pytest.fixture(scope="session")
def build_row():
    """Two walls that courses of the first join."""
    return row


@pytest.fixture(scope="session")
def build_setting():
    return setting


@pytest.fixture(scope="session")
def build_facade():
    """A wall to paint."""
    return facade


@pytest.fixture(scope="session")
def build_ground():
    """The ground to paint."""
    return ground


@pytest.fixture(scope="session")
def brick_lane():
    """Two walls on one pavement, with pixels, and how high the camera stands above it (m)."""
    return lane(), CAMERA_HEIGHT


@pytest.fixture(scope="session")
def paint_photo():
    """What a camera sees of walls and the ground."""
    return paint


@pytest.fixture(scope="session")
def small_camera():
    """The camera of a photo of so few pixels that its depth map is made at once."""
    return SMALL


@pytest.fixture(scope="session")
def build_depth_map():
    """The exact depth map of what a camera sees of walls and the ground."""
    return depth_map


@pytest.fixture(scope="session")
def avenue_walls():
    """Three walls that nothing but a map ties, and their surfaces."""
    return avenue()


@pytest.fixture(scope="session")
def unmoved():
    return still


def links(count, edges, **fields):
    """A bare graph of level segments side by side, with edges that ask for equal depths unless `fields` say so."""
    edges = np.array(edges, int).reshape(-1, 2)
    every = np.ones(len(edges), bool)
    ends = np.array([[[0.0, 40.0 * line], [90.0, 40.0 * line]] for line in range(count)])
    usual = {
        "segments": Segments(ends, np.zeros(count, int)),
        "rays": np.ones((count, 3)),
        "end_rays": np.ones((count, 2, 3)),
        "edges": edges,
        "crossing": np.zeros((len(edges), 2)),
        "gap": np.zeros((len(edges), 2)),
        "kind": np.full(len(edges), "X"),
        "corner": ~every,
        "weight": np.ones(len(edges)),
        "coordinate": np.ones(len(edges), int),
        "log_ratio": np.zeros(len(edges)),
        "tolerance": np.full(len(edges), 0.005),
        "possible": every,
        "informative": every,
    }
    return LineGraph(**{**usual, **fields})


@pytest.fixture(scope="session")
def build_links():
    return links
