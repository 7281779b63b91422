"""Roofs of made houses: what outlines them, and the slope that follows."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.directions import directions_of
from linecad.geometry import central_camera, project
from linecad.model.faces import with_roofs
from linecad.model.regions.evidence import Heaven
from linecad.model.regions.raster import take_raster
from linecad.model.regions.roofs import Sketch, find_roofs
from linecad.model.regions.segments import View
from linecad.scene import Camera, Lines, Plane

WIDTH, HEIGHT = 960, 720
CAMERA = Camera(WIDTH, HEIGHT, central_camera(700.0, WIDTH, HEIGHT), "file")
DISTANCE, EAVE, LEFT, RIGHT, RUN = 20.0, 3.0, -4.0, 5.0, 5.0  # m
SEEN = 0.3  # rad, of which the camera looks past the house


@dataclass(frozen=True, eq=False)
class Made:
    """A roof over an eave along x, before a camera that is turned."""

    rotation: np.ndarray
    corners: np.ndarray  # (4, 3): left eave, left ridge, right ridge, right eave
    pixels: np.ndarray  # (4, 2)
    sketch: Sketch
    lines: Lines
    heaven: Heaven

    def found(self, **changes):
        """The roofs, with other lines, another sketch or another sky."""
        given = {"sketch": self.sketch, "lines": self.lines, "heaven": self.heaven} | changes
        raster = take_raster(given["lines"], CAMERA, self.rotation, None)
        return find_roofs(given["sketch"], given["lines"], given["heaven"], raster, View(CAMERA, self.rotation, None))


def build(degrees=40.0, turn=SEEN, off=0.0, verges=2):
    """A roof that rises away from the camera; its house is turned by `off` against the axes."""
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    rise = RUN * np.tan(np.radians(degrees))
    corners = np.array(
        [[LEFT, 0, EAVE], [LEFT, RUN, EAVE + rise], [RIGHT, RUN, EAVE + rise], [RIGHT, 0, EAVE]], np.float64
    )
    c, s = np.cos(off), np.sin(off)
    corners = corners @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [0, DISTANCE, 0]
    pixels = project(corners, CAMERA.matrix, rotation)
    level, sides = pixels[[[0, 3], [1, 2]]], pixels[[[0, 1], [3, 2]]][:verges]
    lines = Lines(
        id=np.array([7]), axis=np.array([0]), segment=level[:1], ends=corners[[[0, 3]]],
        is_boundary=np.zeros(1, bool), component=np.zeros(1, int), confidence=np.full(1, "supported"),
    )  # fmt: skip
    raster = take_raster(lines, CAMERA, rotation, None)
    house = np.zeros(raster.shape, np.uint8)
    outline = np.rint(raster.samples_of(np.array([*pixels, pixels[3] + [0, HEIGHT], pixels[0] + [0, HEIGHT]])))
    cv2.fillPoly(house, [outline.astype(np.int32)], 1)
    heaven = Heaven((house == 0).ravel(), is_sky=True, is_ceiling=False)
    sketch = Sketch(np.concatenate([level, sides]), level, np.array([0, 0]))
    return Made(rotation, corners, pixels, sketch, lines, heaven)


@pytest.fixture(scope="module")
def made():
    return build()


@given(st.floats(27, 58), st.floats(-0.4, 0.4), st.integers(1, 2))
def test_the_slope_is_that_of_the_roof(degrees, turn, verges):
    made = build(degrees, turn, verges=verges)
    (roof,) = made.found()
    assert (roof.axis, roof.line, roof.has_both) == (1, 0, verges == 2)
    assert np.degrees(roof.slope) == pytest.approx(degrees, abs=1e-6)
    normal = np.cross(made.corners[3] - made.corners[0], made.corners[1] - made.corners[0])
    assert roof.normal(()) == pytest.approx(normal / np.linalg.norm(normal), abs=1e-9)
    assert roof.normal(()) @ roof.eave == pytest.approx(roof.normal(()) @ made.corners[0], abs=1e-6)


@pytest.mark.parametrize("off", [-0.05, 0.05])
def test_one_verge_errs_to_each_side_where_a_house_is_turned_off_the_axes_and_two_hardly(off):
    made = build(off=off)
    ends = made.sketch.raw
    single = [made.found(sketch=replace(made.sketch, raw=np.array([*ends[:2], verge])))[0] for verge in ends[2:]]
    (both,) = made.found()
    assert sorted(np.sign([np.degrees(roof.slope) - 40 for roof in single])) == [-1, 1]
    worst = max(abs(np.degrees(roof.slope) - 40) for roof in single)
    assert abs(np.degrees(both.slope) - 40) < worst / 3


def test_without_a_verge_there_is_no_roof(made):
    assert made.found(sketch=replace(made.sketch, raw=made.sketch.raw[:2])) == ()


def test_a_verge_of_which_little_is_seen_makes_no_roof(made):
    verge = made.sketch.raw[2]
    half = np.stack([verge[0], verge[0] + 0.5 * (verge[1] - verge[0])])
    assert made.found(sketch=replace(made.sketch, raw=np.array([*made.sketch.raw[:2], half]))) == ()


def test_a_verge_in_pieces_is_one(made):
    start, end = made.sketch.raw[2]
    pieces = [np.stack([start + a * (end - start), start + b * (end - start)]) for a, b in ((0, 0.4), (0.5, 1))]
    assert len(made.found(sketch=replace(made.sketch, raw=np.array([*made.sketch.raw[:2], *pieces])))) == 1


def test_without_sky_above_the_ridge_there_is_no_roof(made):
    assert made.found(heaven=replace(made.heaven, seed=np.zeros_like(made.heaven.seed))) == ()
    assert made.found(heaven=Heaven(np.zeros_like(made.heaven.seed), is_sky=False, is_ceiling=False)) == ()


def test_what_the_sky_is_seen_through_is_no_roof(made):
    assert made.found(heaven=replace(made.heaven, seed=np.ones_like(made.heaven.seed))) == ()


def test_an_eave_whose_place_is_a_guess_needs_both_verges(made):
    weak = replace(made.lines, confidence=np.full(1, "weak"))
    assert len(made.found(lines=weak)) == 1
    assert made.found(lines=weak, sketch=replace(made.sketch, raw=made.sketch.raw[:3])) == ()


def test_the_corner_of_a_wall_is_no_verge(made):
    """A castle had a false roof between the foot of a pilaster, a corner of its wall and its ridge."""
    corners = np.array([[LEFT, DISTANCE, EAVE], [LEFT, DISTANCE, EAVE + 4], [RIGHT, DISTANCE, EAVE + 4]])
    foot, top, beyond = project(corners, CAMERA.matrix, made.rotation)
    lines = np.array([made.pixels[[0, 3]], [top, beyond], [foot, top]])
    assert made.found(sketch=Sketch(lines, lines[:2], np.array([0, 0]))) == ()


def test_an_eave_much_shorter_than_its_ridge_makes_no_roof(made):
    start, end = made.lines.segment[0]
    short = np.array([start, start + 0.25 * (end - start)])
    assert made.found(lines=replace(made.lines, segment=short[None])) == ()


def test_a_gable_before_the_sky_is_no_roof():
    """Its verges lean together in the plane of a wall: the ridge between them has no length."""
    made = build()
    apex = (made.pixels[1] + made.pixels[2]) / 2
    raw = np.array([[made.pixels[0], made.pixels[3]], [made.pixels[0], apex], [made.pixels[3], apex]])
    assert made.found(sketch=Sketch(raw, raw[:1], np.array([0]))) == ()


def test_a_roof_becomes_a_plane_with_a_face_where_the_photo_shows_it(made):
    wall = Plane(3, 1, DISTANCE, (7,))
    planes = with_roofs((wall,), made.found(), made.lines, CAMERA, made.rotation, ())
    assert planes[0] is wall
    assert (planes[1].id, planes[1].axis, planes[1].lines) == (4, 1, (7,))
    (face,) = planes[1].faces
    assert face.kind == "roof"
    nearest = np.linalg.norm(face.outline[:, None] - made.corners, axis=2).min(axis=0)
    assert nearest == pytest.approx(np.zeros(4), abs=1e-6)
    assert planes[1].along_normal(face.outline, ()) == pytest.approx(np.full(4, planes[1].offset))


def test_the_normal_of_a_plane_of_a_further_frame_is_turned_from_its_axis():
    plane = Plane(0, 4, -2.0, (), tilt=0.7)
    level = directions_of((0.2,))[4]
    assert plane.normal((0.2,)) == pytest.approx(np.cos(0.7) * level + np.sin(0.7) * np.array([0, 0, 1]))


@pytest.mark.parametrize(("axis", "tilt"), [(2, 0.5), (0, -0.1), (0, 3.2)])
def test_a_plane_with_another_tilt_is_refused(axis, tilt):
    with pytest.raises(ValueError, match="expected"):
        Plane(0, axis, 1.0, (), tilt=tilt)
