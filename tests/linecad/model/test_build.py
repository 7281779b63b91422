"""Which depth maps have a say in the faces of a scene: two facades of a street, with a map of their pixels."""

import numpy as np
import pytest
import shapely

from linecad.depth.depth_map import DepthMap
from linecad.depth.normals import Normals
from linecad.finding import FoundLines
from linecad.geometry import project
from linecad.line_graph import ManhattanFrame, Segments
from linecad.model import build
from linecad.model.regions.find import find_regions
from linecad.options import Options
from linecad.pipeline import reconstruct_lines
from linecad.scene import Camera

Y, Z = 1, 2
CAMERA = Camera(1280, 720, np.array([[640.0, 0, 639.5], [0, 640, 359.5], [0, 0, 1]]), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
LEFT, RIGHT = -6.0, 9.0  # x of the facades


def facade(wall, jambs, heights):
    """Jambs that cross sills, transoms and heads in the plane x = wall."""
    lines = [(Z, (wall, at, heights[0]), (wall, at, heights[-1])) for at in jambs]
    return lines + [(Y, (wall, jambs[0], at), (wall, jambs[-1], at)) for at in heights]


@pytest.fixture(scope="module")
def found():
    """The lines of both facades."""
    lines = facade(LEFT, [8.0, 9.3, 10.4, 11.7, 13.1, 14.2], [-1.2, 0.1, 0.8, 2.4])
    lines += facade(RIGHT, [15.0, 17.9, 20.1, 23.4, 25.2], [-0.6, 0.4, 1.5, 3.9])
    ends = np.array([line[1:] for line in lines], float)
    segments = Segments(project(ends, CAMERA.matrix, AHEAD), [line[0] for line in lines])
    return FoundLines(CAMERA, ManhattanFrame(AHEAD, 0.0, 1.0), segments, ())


@pytest.fixture(scope="module")
def depth():
    """Depths (H, W) of the facades, endless ones, but for the far end of the street."""
    slope = (np.arange(CAMERA.width) - CAMERA.matrix[0, 2]) / CAMERA.focal
    across = np.where(slope < 0, LEFT, RIGHT) / slope
    return np.broadcast_to(np.minimum(across, 100.0), (CAMERA.height, CAMERA.width))


@pytest.fixture(scope="module")
def vectors():
    """Normals (H, W, 3) of both facades, and elsewhere on the upper row of windows of the left one."""
    vectors = np.empty((CAMERA.height, CAMERA.width, 3))
    vectors[:] = AHEAD[:, 0]
    upper = np.array([[LEFT, y, z] for y, z in ((8.0, 0.9), (14.2, 0.9), (14.2, 2.3), (8.0, 2.3))])
    row, column = np.indices(vectors.shape[:2])
    outline = shapely.Polygon(project(upper, CAMERA.matrix, AHEAD))
    vectors[shapely.contains_xy(outline, column.ravel(), row.ravel()).reshape(row.shape)] = AHEAD[:, Z]
    return vectors


def scene_of(found, depth=None):
    return reconstruct_lines("street.png", found, Options(collinear=False, over_bodies=True), depth=depth).scene


@pytest.fixture
def looks(monkeypatch):
    """What scenes were given to look at for their faces."""
    seen = []

    def find(planes, lines, camera, rotation, look, turns):
        seen.append(look)
        return find_regions(planes, lines, camera, rotation, look, turns)

    monkeypatch.setattr(build, "find_regions", find)
    return seen


def map_of(values, vectors):
    return DepthMap("map.npz", values, values > 0, "z", normals=Normals(vectors))


def test_the_normals_of_a_map_have_a_say(found, depth, vectors, looks):
    heard = scene_of(found, map_of(depth, vectors))
    assert heard.depth_map.left_out == ""
    scene_of(found)
    scene_of(found, DepthMap("map.npz", depth, depth > 0, "z"))
    assert [None if look.normals is None else look.normals.vectors.tobytes() for look in looks] == [
        vectors.tobytes(), None, None
    ]  # fmt: skip


def test_those_of_a_map_that_is_left_out_have_none(found, depth, vectors, looks):
    left_out = scene_of(found, map_of(np.ones(depth.shape), vectors))
    assert left_out.depth_map.left_out == "it holds one depth throughout"
    assert [look.normals for look in looks] == [None]


def test_the_facade_that_the_photo_shows_has_a_face_up_to_its_top(found):
    scene = scene_of(found)
    (left,) = [plane for plane in scene.planes if plane.axis == 0 and plane.offset < 0]
    tops = [face.outline[:, 2].max() for face in left.faces]
    assert max(tops) == scene.lines.ends[scene.lines.ends[:, 0, 0] < 0][..., 2].max()


def test_a_line_that_the_map_has_elsewhere_is_there(found, depth):
    """A jamb of the right facade that the map has before it, with what is beside it."""
    at = project(np.array([RIGHT, 20.1, 0.0]), CAMERA.matrix, AHEAD)[0]
    before = np.where(np.abs(np.arange(CAMERA.width) - at) < 14, 0.6 * depth, depth)
    scenes = [scene_of(found, DepthMap("map.npz", values, values > 0, "z")) for values in (depth, before)]
    jambs = []
    for scene in scenes:
        lines = scene.lines
        row = int(np.flatnonzero((lines.axis == Z) & (np.abs(lines.segment[..., 0] - at) < 1).all(axis=1)).item())
        others = np.delete(np.arange(len(lines)), row)
        jambs.append((lines.ends[row, 0, 1] / np.median(lines.ends[others, 0, 1]), bool(lines.by_depth_map[row])))
    (there, _), (nearer, is_by_map) = jambs
    assert is_by_map
    assert nearer == pytest.approx(0.6 * there, rel=0.02)
    assert any("depth map has elsewhere" in note for note in scenes[1].notes)
    assert not any("depth map has elsewhere" in note for note in scenes[0].notes)
