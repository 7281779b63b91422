"""Line graphs of made scenes: lines in space, a camera, and the records that an honest front end would hand over."""

import importlib.util
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from linecad.directions import across, directions_of, third
from linecad.line_graph import LineGraph, Segments

FOCAL = 1000.0
CENTRE = np.array([960.0, 640.0])


def camera_rotation(yaw, pitch):
    """World (x right, y away, z up) to camera (x right, y down, z forward)."""
    base = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    c, s = np.cos(pitch), np.sin(pitch)
    nod = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    return nod @ base @ turn


def image_crossing(first, second):
    """Where the two infinite image lines through two segments (2, 2) px meet."""
    a, b = (np.cross([*ends[0], 1.0], [*ends[1], 1.0]) for ends in (first, second))
    x, y, w = np.cross(a, b)
    return [x / w, y / w]


def line_graph(
    lines, edges=None, *, tolerance=0.01, weight=1.0, informative=True, kind="X", yaw=0.3, pitch=0.1, turns=()
):
    """The graph of `lines`, each (axis, point, low, high): all points with component `axis` from low to high.

    `turns` are those of further frames. `edges` are pairs of lines of different axes, or of one axis (collinear); all
    pairs of different axes if None. The other arguments are one value for all edges or one each.
    """
    rotation = camera_rotation(yaw, pitch)
    axis = np.array([line[0] for line in lines], int).reshape(-1)
    ends = np.empty((len(lines), 2, 3))
    for i, (a, point, low, high) in enumerate(lines):
        if a < 3:
            ends[i] = point
            ends[i, :, a] = low, high
        else:
            along = directions_of(turns)[a]
            ends[i] = point + (np.array([low, high]) - along @ point)[:, None] * along
    in_camera = ends @ rotation.T
    assert (in_camera[..., 2] > 0).all(), "a line of the made scene lies behind the camera"
    end_rays = ends / in_camera[..., 2:]
    rays = end_rays.mean(axis=1)
    pixels = FOCAL * in_camera[..., :2] / in_camera[..., 2:] + CENTRE
    if edges is None:
        edges = [(i, j) for i in range(len(lines)) for j in range(i + 1, len(lines)) if axis[i] != axis[j]]
    edges = np.array(edges, int).reshape(-1, 2)
    i, j = edges.T
    same = axis[i] == axis[j]
    coordinate = np.where(same, across(axis[i])[..., 0], third(axis[i], axis[j]))
    along = directions_of(turns)[coordinate]
    d_i, d_j = ((rays[line] * along).sum(axis=1) for line in (i, j))
    possible = d_i * d_j > 0
    return LineGraph(
        segments=Segments(pixels, axis),
        rays=rays,
        end_rays=end_rays,
        edges=edges,
        crossing=[[0.0, 0.0] if same[e] else image_crossing(pixels[i[e]], pixels[j[e]]) for e in range(len(edges))],
        gap=np.zeros((len(edges), 2)),
        kind=np.where(same, "collinear", np.broadcast_to(kind, len(edges))),
        corner=np.zeros(len(edges), bool),
        weight=np.broadcast_to(np.asarray(weight, float), len(edges)),
        coordinate=coordinate,
        log_ratio=np.where(possible, np.log(np.abs(np.where(possible, d_j / d_i, 1.0))), 0.0),
        tolerance=np.broadcast_to(np.asarray(tolerance, float), len(edges)),
        possible=possible,
        informative=np.broadcast_to(np.asarray(informative, bool), len(edges)),
        turns=turns,
    )


def street_lines(count):
    """Lines at random places of a coarse grid, so that some meet, and an eighth of all their crossings as edges."""
    rng = np.random.default_rng(1)
    lines = []
    for _ in range(count):
        axis = int(rng.integers(3))
        point = np.array([rng.integers(-4, 5), rng.integers(6, 14), rng.integers(-3, 4)]) + 0.37
        low = point[axis] + rng.uniform(-1.5, -0.2)
        lines.append((axis, point, low, low + rng.uniform(1.0, 3.0)))
    pairs = [(i, j) for i in range(count) for j in range(i + 1, count) if lines[i][0] != lines[j][0]]
    return lines, [pair for pair in pairs if rng.random() < 0.12]


@pytest.fixture(scope="session")
def build_graph():
    return line_graph


@pytest.fixture(scope="session")
def change():
    """dataclasses.replace, to break one field of a graph or of options."""
    return replace


@pytest.fixture(scope="session")
def corner(build_graph):
    """Three lines that meet in the point (1, 5, 2): a true corner, the paper's xyz 3-cycle."""
    return build_graph([(0, (0, 5, 2), 1, 3), (1, (1, 0, 2), 5, 7), (2, (1, 5, 0), -1, 2)])


@pytest.fixture(scope="session")
def street(build_graph):
    """With family cycles alone too much for SCIP to finish within a minute."""
    return build_graph(*street_lines(60), tolerance=0.004)


@pytest.fixture(scope="session")
def alley(build_graph):
    """36 lines with 52 crossings, most of them fake: without P and B formulation "gain" takes hundreds of nodes."""
    return build_graph(*street_lines(36), tolerance=0.004)


@pytest.fixture(scope="session")
def streets():
    """The module of the benchmarks that draws made streets."""
    path = Path(__file__).parents[1] / "benchmarks" / "instances.py"
    spec = importlib.util.spec_from_file_location("benchmark_instances", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up there
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def street_graph(streets):
    """The line graph of a made street of the benchmarks, by seed and number of lines; each is drawn once."""
    small = streets.SMALL_SIZE

    def draw(seed, lines):
        # Of a street with many more lines the longest lie on one facade, and hardly any crossing is fake.
        bay = small.bay * (small.lines / lines) ** 0.5
        return streets.make_instance(seed, replace(small, lines=lines, bay=bay)).graph

    return cache(draw)
