"""Walls of any direction with windows anywhere: what is cut out is what the scene says."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from exporters.faces import signed_area
from exporters.ifc.voids import Side, build_voids, host_of
from exporters.model import build_model
from linecad.directions import directions_of
from linecad.scene import Face, Opening, Plane

UP = np.array([0.0, 0.0, 1.0])


def in_wall(axis, offset, turns, corners):
    """Points (N, 3) of a wall from their u and v."""
    directions = directions_of(turns)
    along = directions[{0: 1, 1: 0, 3: 4, 4: 3}[axis]]
    return np.array([offset * directions[axis] + u * along + v * UP for u, v in corners])


def rectangle(u0, u1, v0, v1):
    return [(u0, v0), (u1, v0), (u1, v1), (u0, v1)]


@st.composite
def walls(draw):
    """The axis, the offset and the turn of a wall 12 x 8, and the rectangles of windows in it, one in each cell."""
    axis = draw(st.sampled_from([0, 1, 3, 4]))
    offset = draw(st.sampled_from([-1, 1])) * draw(st.floats(2, 40))
    turn = draw(st.floats(-0.7, 0.7).filter(lambda value: abs(value) > 0.02))
    cells = draw(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 3)), min_size=1, max_size=5, unique=True))
    share = st.floats(0.05, 0.45)
    boxes = []
    for column, row in cells:
        left, right, low, high = (draw(share) for _ in range(4))
        boxes.append((2 * column + 2 * left, 2 * column + 2 - 2 * right, 2 * row + 2 * low, 2 * row + 2 - 2 * high))
    return axis, offset, (turn,), boxes


def build_scene(scene, axis, offset, turns, boxes):
    holes = tuple(in_wall(axis, offset, turns, rectangle(*box)) for box in boxes)
    faces = [Face(0, in_wall(axis, offset, turns, rectangle(0, 12, 0, 8)), holes, "wall")]
    faces += [Face(1 + number, hole, (), "window", opening=number) for number, hole in enumerate(holes)]
    openings = tuple(Opening(number, 5, *box, "window") for number, box in enumerate(boxes))
    return replace(scene, planes=(Plane(5, axis, offset, (), tuple(faces)),), openings=openings, turns=turns)


@given(walls())
def test_openings_are_the_holes_of_their_wall_whatever_its_direction(no_lines, drawn):
    boxes = drawn[-1]
    model = build_model(replace(build_scene(no_lines, *drawn), metres_per_unit=1.7))
    face = model.loose_faces[0]
    side = Side.of(face)
    assert np.linalg.det([side.along, side.away, UP]) == pytest.approx(1.0)
    assert side.flat(face.rings[0]).min(axis=0) == pytest.approx(np.zeros(2), abs=1e-9)
    assert (face.vertices - side.origin) @ side.away == pytest.approx(np.zeros(len(face.vertices)), abs=1e-9)
    assert signed_area(side.flat(face.rings[0])) > 0  # from where it is looked at, x runs to the right
    voids = build_voids(model)
    assert [host_of(void, [(face, side)]) for void in voids] == [0] * len(boxes)
    closed = shapely.union_all([side.polygon(face), *(void.box(side) for void in voids)], grid_size=1e-7)
    assert len(closed.interiors) == 0
    assert closed.area == pytest.approx(12 * 8 * 1.7**2)
    assert side.polygon(face).area + sum(void.box(side).area for void in voids) == pytest.approx(closed.area)


def test_an_opening_is_of_the_wall_that_has_its_hole_not_of_one_beside_it(row):
    model = build_model(row)
    face = next(face for face in model.faces if face.kind == "wall")
    beside = replace(face, id=99, rings=(face.rings[0] + np.array([20.0, 0, 0]),))
    other_plane = replace(face, id=98, plane=77)
    voids = build_voids(model)
    for order in ((face, beside, other_plane), (other_plane, beside, face)):
        walls = [(each, Side.of(each)) for each in order]
        assert {host_of(void, walls) for void in voids} == {face.id}
    assert host_of(voids[0], [(beside, Side.of(beside))]) is None
