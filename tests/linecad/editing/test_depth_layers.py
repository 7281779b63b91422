"""The pictures of a depth map: known planes, lines and maps, and the colours of what differs."""

import re
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

import linecad.editing
from linecad.depth.depth_map import DepthMap
from linecad.editing import depth_layers
from linecad.editing.depth_layers import DIVERGING, FULL, RAMP, log_ratio, picture_of_difference, picture_of_map
from linecad.geometry import homogeneous, project
from linecad.scene import Camera, DepthMapReport, Face, Intersections, Lines, Plane, Scene, SolveReport

WIDTH, HEIGHT = 160, 120
CAMERA = Camera(WIDTH, HEIGHT, [[100, 0, 79.5], [0, 100, 59.5], [0, 0, 1]], "focal option")
ROTATION = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # looks along y, z up
RAYS = homogeneous(np.stack(np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT)), axis=-1)) @ np.linalg.inv(CAMERA.matrix).T
SCALE, SHIFT = 2.5, 0.03
WALL = Plane(0, 1, 5.0, (), (Face(0, [[-2, 5, -0.5], [0, 5, -0.5], [0, 5, 2], [-2, 5, 2]]),))
FLOOR = Plane(1, 2, -1.0, (), (Face(1, [[-2, 2.5, -1], [2, 2.5, -1], [2, 5, -1], [-2, 5, -1]]),))


def scene_of(planes=(), ends=(), kind="z", **more):
    """A scene with these planes and lines along x, and a report on a map of that kind."""
    ends = np.array(ends, float).reshape(-1, 2, 3)
    count = len(ends)
    lines = Lines(
        np.arange(count), np.zeros(count), project(ends, CAMERA.matrix, ROTATION), ends, [False] * count,
        [0] * count, ["weak"] * count,
    )  # fmt: skip
    report = DepthMapReport(
        "a.npz", "", kind=kind, shift=SHIFT if kind == "affine-inverse" else 0.0, scale=SCALE, width=0.01
    )
    return Scene(
        "a.jpg", CAMERA, ROTATION, lines, Intersections([], [], [], [], [], []), tuple(planes),
        SolveReport("none", "bodies", "optimal", 0, 0, 0), depth_map=report, **more,
    )  # fmt: skip


def map_of(depth, kind="z"):
    """The map that shows these camera depths (H, W), 0 for none, in units of its own."""
    own = SCALE * np.broadcast_to(np.asarray(depth, float), (HEIGHT, WIDTH))
    valid = own > 0
    safe = np.where(valid, own, 1)
    values = {
        "z": safe,
        "distance": safe * np.linalg.norm(RAYS, axis=-1),
        "inverse": 1 / safe,
        "affine-inverse": 1 / safe - SHIFT,
    }[kind]
    return DepthMap("a.npz", np.where(valid, values, 0), valid, None)


def at(image, x, y, z):
    """The value of an image where the photo shows a point in space."""
    column, row = np.rint(project(np.array([x, y, z], float), CAMERA.matrix, ROTATION)).astype(int)
    return image[row, column]


def colours(data):
    """(h, w, 4) red, green, blue, alpha, with sign."""
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    return cv2.cvtColor(image, cv2.COLOR_BGRA2RGBA).astype(int)


def rgb(stop):
    return [int(stop[k : k + 2], 16) for k in (1, 3, 5)]


@pytest.mark.parametrize("off", [0.9, 1.0, 1.1])
def test_on_a_face_it_is_how_much_farther_the_map_is_and_elsewhere_nothing(off):
    ratio = log_ratio(map_of(5.0 * off), scene_of([WALL]))
    assert ratio.shape == (HEIGHT, WIDTH)
    assert at(ratio, -1, 5, 1) == pytest.approx(np.log(off), abs=1e-6)
    assert np.isnan(at(ratio, 1, 5, 1))
    covered = (2 / 5 * 100) * (2.5 / 5 * 100)
    assert np.isfinite(ratio).sum() == pytest.approx(covered, rel=0.05)


@pytest.mark.parametrize("kind", ["z", "distance", "inverse", "affine-inverse"])
def test_a_true_map_of_any_kind_agrees_with_a_wall_and_a_floor(kind):
    floor = -1.0 / (RAYS @ ROTATION)[..., 2]
    depth = np.where((floor > 0) & (floor < 5), floor, 5)
    ratio = log_ratio(map_of(depth, kind), scene_of([WALL, FLOOR], kind=kind))
    assert np.isfinite(ratio).sum() > 3000
    assert np.nanmax(np.abs(ratio)) < 1e-5
    assert np.isfinite(at(ratio, 1, 3, -1))


def test_of_two_faces_the_nearer_one_is_compared():
    behind = replace(WALL, id=2, offset=8.0, faces=(Face(2, [[-3, 8, -3], [3, 8, -3], [3, 8, 3], [-3, 8, 3]]),))
    ratio = log_ratio(map_of(5.0), scene_of([behind, WALL]))
    assert at(ratio, -1, 5, 1) == pytest.approx(0, abs=1e-6)
    assert at(ratio, 1, 5, 1) == pytest.approx(np.log(5 / 8), abs=1e-6)


def test_a_known_length_changes_nothing():
    depth = map_of(5.5)
    one, other = (log_ratio(depth, scene_of([WALL], metres_per_unit=unit)) for unit in (None, 0.3))
    assert one == pytest.approx(other, abs=1e-6, nan_ok=True)


def test_a_line_has_its_own_depth():
    ratio = log_ratio(map_of(4.0), scene_of(ends=[[[-1, 5, 0.5], [1, 5, 0.5]]]))
    for x in (-0.9, 0.0, 0.9):
        assert at(ratio, x, 5, 0.5) == pytest.approx(np.log(4 / 5))
    assert np.isnan(at(ratio, 0, 5, 0.7))
    assert np.isnan(at(ratio, 1.3, 5, 0.5))


def test_a_line_that_recedes_has_the_depth_of_each_of_its_points():
    # Straight down the middle of the photo, so that the floor on either side is as deep as on the line.
    scene = scene_of(ends=[[[0, 3, -1], [0, 9, -1]]])
    floor = -1.0 / (RAYS @ ROTATION)[..., 2]
    depth = np.where(floor > 0, floor, 50)
    for off in (0.9, 1.0, 1.2):
        ratio = log_ratio(map_of(depth * off), scene)
        told = np.nonzero(np.isfinite(ratio))
        assert np.ptp(told[0]) > 20  # px: 22 between the ends
        assert np.abs(ratio[told] - np.log(off)).max() < 0.05  # a piece of the line has one value
        assert np.median(ratio[told]) == pytest.approx(np.log(off), abs=0.02)


def test_the_upper_edge_of_a_wall_agrees_where_the_map_has_what_is_behind_it_on_the_other_side():
    top = project(np.array([0.0, 5, 1]), CAMERA.matrix, ROTATION)[1]
    depth = np.where(np.arange(HEIGHT)[:, None] >= top, 5.0, 20.0)
    ratio = log_ratio(map_of(depth), scene_of(ends=[[[-1, 5, 1], [1, 5, 1]]]))
    assert at(ratio, 0, 5, 1) == pytest.approx(0, abs=1e-6)


def test_where_the_map_has_no_depth_nothing_is_told():
    hole = np.full((HEIGHT, WIDTH), 5.0)
    hole[:, : WIDTH // 2] = 0
    scene = scene_of([WALL], [[[-1, 5, 0.5], [1, 5, 0.5]]])
    ratio = log_ratio(map_of(hole), scene)
    assert np.isnan(ratio[:, : WIDTH // 2 - 4]).all()
    assert at(ratio, 0.5, 5, 0.5) == pytest.approx(0, abs=1e-6)


def test_a_line_that_reaches_behind_the_camera_is_not_compared():
    scene = scene_of(ends=[[[-1, 3, -1], [-1, 9, -1]]])
    behind = replace(scene, lines=replace(scene.lines, ends=[[[-1, -3, -1], [-1, 9, -1]]]))
    assert np.isnan(log_ratio(map_of(5.0), behind)).all()


def test_a_map_that_was_left_out_is_compared_with_nothing():
    scene = scene_of([WALL])
    for report in (None, DepthMapReport("a.npz", "it is flat")):
        assert picture_of_difference(map_of(5.0), replace(scene, depth_map=report)) is None


@pytest.mark.parametrize(
    ("off", "colour"),
    [
        (np.exp(-3 * FULL), DIVERGING[0]), (np.exp(-FULL), DIVERGING[0]), (np.exp(-FULL / 2), DIVERGING[1]),
        (1.0, DIVERGING[2]), (np.exp(FULL / 2), DIVERGING[3]), (np.exp(FULL), DIVERGING[4]), (9.0, DIVERGING[4]),
    ],
)  # fmt: skip
def test_the_colour_says_which_is_farther_and_by_how_much(off, colour):
    image = colours(picture_of_difference(map_of(5.0 * off), scene_of([WALL])))
    assert at(image, -1, 5, 1) == pytest.approx([*rgb(colour), 255], abs=2)
    assert at(image, 1, 5, 1).tolist() == [0, 0, 0, 0]


def test_the_ramp_runs_from_near_to_far_by_the_log_of_the_depth():
    depth = np.broadcast_to(np.geomspace(1, 10, WIDTH), (HEIGHT, WIDTH)).copy()
    depth[:10] = 0
    for kind in ("z", "inverse", "affine-inverse"):
        shift = SHIFT if kind == "affine-inverse" else 0.0
        image = colours(picture_of_map(map_of(depth, kind), CAMERA, kind, shift))
        assert (image[:10] == 0).all()
        for share, stop in zip((0.01, 0.25, 0.5, 0.75, 0.99), RAMP, strict=True):
            assert image[60, round(share * (WIDTH - 1))] == pytest.approx([*rgb(stop), 255], abs=6)


def test_a_map_of_one_depth_and_one_without_any_have_a_picture_too():
    assert (colours(picture_of_map(map_of(3.0), CAMERA, "z", 0.0))[..., 3] == 255).all()
    assert (colours(picture_of_map(map_of(0.0), CAMERA, "z", 0.0)) == 0).all()


def test_the_picture_of_a_large_photo_is_smaller_and_shows_the_same_place(monkeypatch):
    depth = np.full((HEIGHT, WIDTH), 5.0)
    depth[:, 40:] = 50
    whole = colours(picture_of_map(map_of(depth), CAMERA, "z", 0.0))
    monkeypatch.setattr(depth_layers, "MOST_SIDE", 80)
    camera = replace(CAMERA)  # another record: pictures are kept by camera
    half = colours(picture_of_map(map_of(depth), camera, "z", 0.0))
    assert half.shape == (HEIGHT // 2, WIDTH // 2, 4)
    assert (half == whole[::2, ::2]).all()
    ratio = log_ratio(map_of(5.0), scene_of([WALL]))
    left, right = np.flatnonzero(np.isfinite(ratio[25]))[[0, -1]]
    assert (left, right) == pytest.approx((19.75, 39.75), abs=1)  # x of -2 and 0 at depth 5, in px twice as large


def test_the_legend_of_the_page_has_the_colours_of_the_pictures():
    style = (Path(linecad.editing.__file__).parent / "page" / "style.css").read_text(encoding="utf-8")
    for layer, stops in (("depth", RAMP), ("difference", DIVERGING)):
        (found,) = re.findall(rf"\.ramp\.{layer} {{ background: linear-gradient\(90deg, (.+?)\); }}", style)
        assert tuple(found.split(", ")) == stops
    script = (Path(linecad.editing.__file__).parent / "page" / "depthlayers.js").read_text(encoding="utf-8")
    assert f"map {100 * FULL:.0f} % nearer" in script
