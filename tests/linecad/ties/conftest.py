"""Walls of grids before a level camera: exact lines, their graph, their true depths, and bodies made of them."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from linecad.arrays import Float, Int
from linecad.decide.stability import Fits
from linecad.geometry import central_camera, project, rotation_about
from linecad.graph.build import build_line_graph
from linecad.line_graph import LineGraph, ManhattanFrame, Segments
from linecad.options import LONG_REACH
from linecad.scene import Camera
from linecad.ties.bodies import RigidBodies
from linecad.ties.setting import Setting, Sight

WIDTH, HEIGHT, FOCAL = 3840, 2880, 3000.0
CAMERA = Camera(WIDTH, HEIGHT, central_camera(FOCAL, WIDTH, HEIGHT), "file")
FRONTAL = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 0.0, 1.0)  # x right, y away, z up
FITS = 4


@dataclass(frozen=True, eq=False)
class Town:
    """Parts of lines, each (axis, point, other end), that the camera sees."""

    graph: LineGraph
    sight: Sight  # without pixels
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


def town(*parts, collinear=True, yaw=0.0, pitch=0.0):
    """What the camera sees of parts; every line must be long enough to be seen.

    The camera is turned to the right by `yaw` and then up by `pitch` (rad).
    """
    lines = [line for part in parts for line in part]
    axis = np.array([line[0] for line in lines])
    ends = np.array([line[1:] for line in lines], float)
    level = FRONTAL.rotation @ rotation_about(np.array([0.0, 0.0, yaw]))
    rotation = rotation_about(np.array([-pitch, 0.0, 0.0])) @ level
    pixels = project(ends, CAMERA.matrix, rotation)
    assert ends[..., 1].min() > 1
    assert pixels.min() > 0
    assert (pixels < [WIDTH, HEIGHT]).all()
    frame = ManhattanFrame(rotation, 0.0, 1.0)
    graph = build_line_graph(Segments(pixels, axis), CAMERA, frame, LONG_REACH, "odds", collinear)
    assert len(graph.segments) == len(lines)
    # The ray of a middle has depth 1; across its axis it is the line's own coordinate over the depth.
    fixed = np.where(axis == 1, np.where(np.abs(graph.rays[:, 0]) > np.abs(graph.rays[:, 2]), 0, 2), 1)
    at = np.arange(len(lines))
    log_depth = np.log(ends[at, 0, fixed] / graph.rays[at, fixed])
    part = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    return Town(graph, Sight(CAMERA.matrix, rotation, WIDTH, None), log_depth, part)


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
