"""Windows and doors that a person drew, in place of those that were found, and places where there are none.

A rectangle is told by two opposite corners in the photo. Where their rays meet its wall they have two coordinates along
the wall's axes, so that it is one in space, whatever the perspective.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from linecad.arrays import Float
from linecad.corrections.edits import FaceEdit, NoWindow, Window
from linecad.directions import UP, Turns, axis_name, components, partner
from linecad.geometry import project, world_rays
from linecad.model.openings.choice import not_overlapping
from linecad.model.openings.corners import rectangle_in_space
from linecad.model.openings.cutting import with_openings
from linecad.model.openings.homes import at_home
from linecad.scene import Camera, Lines, Opening, Plane

EQUAL = 0.1  # log of a side by which windows of one size differ that a hand has drawn
TOUCHING = 1e-9  # of a window, by which equal ones may overlap that stand side by side


@dataclass(frozen=True, eq=False)
class _Placed:
    """An opening with its wall."""

    opening: Opening
    wall: Plane
    shape: shapely.Polygon  # px
    is_told: bool


@dataclass(frozen=True, eq=False)
class ToldOpenings:
    """What a person said about the openings of a scene."""

    faces: Sequence[FaceEdit]
    planes: tuple[Plane, ...]  # with the faces that are seen, which openings are cut out of where `cut` is empty
    lines: Lines
    camera: Camera
    rotation: Float  # (3, 3) world to camera
    turns: Turns = ()
    cut: tuple[Plane, ...] = ()  # the same planes, whose faces may go on unseen: openings are cut out of these

    def opened(self, found: tuple[Opening, ...]) -> tuple[tuple[Plane, ...], tuple[Opening, ...], tuple[str, ...]]:
        """The planes with their openings cut out, those in the walls that the photo shows around them, and notes."""
        openings, notes = self.among(at_home(found, self.planes, self.camera, self.rotation, self.turns))
        return *with_openings(self.cut or self.planes, openings, self.turns), notes

    def among(self, found: tuple[Opening, ...]) -> tuple[tuple[Opening, ...], tuple[str, ...]]:
        """The openings found and told, with ids and shapes numbered anew, and notes on what could not be taken.

        A told one takes the place of those that it overlaps in the photo; how deep its pane is it has of these, else of
        an equal one in its wall.
        """
        if not any(isinstance(edit, Window | NoWindow) for edit in self.faces):
            return found, ()
        plane_of = {plane.id: plane for plane in self.planes}
        placed = [self._placed(opening, plane_of[opening.plane], is_told=False) for opening in found]
        notes: list[str] = []
        for number, edit in enumerate(self.faces):
            match edit:
                case NoWindow():
                    placed = [each for each in placed if not each.shape.intersects(shapely.Point(edit.at))]
                case Window():
                    grid = self._grid(edit, -1 - number)
                    if isinstance(grid, str):
                        notes.append(grid)
                        continue
                    free = not_overlapping([each.shape for each in placed], [each.shape for each in grid])
                    taken = [each for each, is_free in zip(placed, free.tolist(), strict=True) if not is_free]
                    kept = [each for each, is_free in zip(placed, free.tolist(), strict=True) if is_free]
                    placed = [*kept, *_as_deep_as(grid, taken, kept)]
        return _numbered(placed), (*notes, *self._notes(placed))

    def _placed(self, opening: Opening, wall: Plane, is_told: bool) -> _Placed:
        corners = project(rectangle_in_space(opening, wall, self.turns), self.camera.matrix, self.rotation)
        return _Placed(opening, wall, shapely.Polygon(corners), is_told)

    def _grid(self, edit: Window, shape: int) -> list[_Placed] | str:
        """The windows of one edit, row by row, all of that shape, or why there are none."""
        u, v = np.mean(edit.corners, axis=0)
        where = f"a {edit.kind} drawn at ({u:.0f}, {v:.0f})"
        wall = self._wall(edit)
        if wall is None:
            return f"{where} is left out: no wall across {axis_name(edit.wall.normal)} is there"
        rectangles = rectangles_on(edit, (wall.axis, wall.offset), self.camera, self.rotation, self.turns)
        if isinstance(rectangles, str):
            return f"{where} is left out: {rectangles}"
        return [
            self._placed(Opening(0, wall.id, u0, u1, v0, v1, edit.kind, shape=shape), wall, is_told=True)
            for u0, u1, v0, v1 in rectangles.tolist()
        ]

    def _wall(self, edit: Window) -> Plane | None:
        """The wall that an edit names: the plane of a face there of that normal, else the plane of its line."""
        named = None
        if edit.wall.line is not None:
            row = self.lines.row_by_look.get((edit.wall.line.axis, np.array(edit.wall.line.ends).tobytes()))
            number = None if row is None else int(self.lines.id[row])
            planes = [plane for plane in self.planes if plane.axis == edit.wall.normal and number in plane.lines]
            named = next(iter(planes), None)
        middle = shapely.Point(np.mean(edit.corners, axis=0))
        there = [
            plane
            for plane in self.planes
            if plane.axis == edit.wall.normal and not plane.tilt
            for face in plane.faces
            if shapely.Polygon(project(face.outline, self.camera.matrix, self.rotation)).buffer(0).contains(middle)
        ]
        if named is None or not there:
            return next(iter(there), named)
        own = named.offset
        return min(there, key=lambda plane: abs(plane.offset - own))

    def _notes(self, placed: list[_Placed]) -> list[str]:
        """What a reader should know of told openings: those that no face has around them are no holes."""
        outside = 0
        plane_of = {plane.id: plane for plane in self.cut or self.planes}
        for each in placed:
            faces = [
                shapely.Polygon(project(face.outline, self.camera.matrix, self.rotation)).buffer(0)
                for face in plane_of[each.wall.id].faces
            ]
            outside += each.is_told and not any(face.covers(each.shape) for face in faces)
        if not outside:
            return []
        return [f"{outside} of the windows and doors that you drew reach beyond the face of their wall: no holes"]


def rectangles_on(edit: Window, wall: tuple[int, float], camera: Camera, rotation: Float, turns: Turns) -> Float | str:
    """u0, u1, v0 and v1 (W, 4) of the windows of an edit on a wall of a direction at an offset, row by row.

    Or why there are none, in words.
    """
    axis, offset = wall
    pixels = np.array([*edit.corners, edit.last if edit.last is not None else edit.corners[1]])
    rays = components(world_rays(pixels, camera.matrix, rotation), turns)
    if (rays[:, axis] * offset <= 0).any():
        return "it would go on behind the camera"
    flat = rays[:, [int(partner(axis)), UP]] * (offset / rays[:, axis])[:, None]
    size = np.abs(flat[1] - flat[0])
    count = np.array([edit.columns, edit.rows])
    step = np.where(count > 1, (flat[2] - flat[1]) / np.maximum(count - 1, 1), 0.0)
    if (size <= 0).any() or ((count > 1) & (np.abs(step) < size * (1 - TOUCHING))).any():
        return "it has no area, or its rows and columns overlap"
    row, column = np.indices((edit.rows, edit.columns)).reshape(2, -1)
    low = flat[:2].min(axis=0) + step * np.column_stack([column, row])
    return np.stack([low[:, 0], low[:, 0] + size[0], low[:, 1], low[:, 1] + size[1]], axis=1)


def _as_deep_as(grid: list[_Placed], taken: list[_Placed], others: list[_Placed]) -> list[_Placed]:
    """Windows with the recess of the one among those whose places they take that they cover most of; all the same.

    Where they take none's, it is that of the nearest other one in their wall that is as large and of their kind: who
    draws a window that was missed means one as those beside it.
    """
    deep = [each for each in taken if each.opening.recess is not None]
    every = shapely.union_all([each.shape for each in grid])
    if deep:
        one = max(deep, key=lambda each: float(shapely.intersection(each.shape, every).area))
    else:
        alike = [each for each in others if each.opening.recess is not None and _is_alike(each, grid[0])]
        if taken or not alike:
            return grid
        one = min(alike, key=lambda each: float(each.shape.distance(every)))
    assert one.opening.recess is not None
    ratio = one.opening.recess / abs(one.wall.offset)
    return [
        replace(
            each,
            opening=replace(each.opening, recess=ratio * abs(each.wall.offset), panel=(1 + ratio) * each.wall.offset),
        )
        for each in grid
    ]


def _is_alike(one: _Placed, other: _Placed) -> bool:
    """Whether two openings of a kind lie in one wall and are of one size."""
    sizes = [np.array([each.u1 - each.u0, each.v1 - each.v0]) for each in (one.opening, other.opening)]
    is_equal = (np.abs(np.log(sizes[0] / sizes[1])) <= EQUAL).all()
    return bool(is_equal) and (one.wall.id, one.opening.kind) == (other.wall.id, other.opening.kind)


def _numbered(placed: list[_Placed]) -> tuple[Opening, ...]:
    """The openings with their places as ids, and the place of the first of each shape in one plane as its shape."""
    numbers: dict[tuple[int, int], int] = {}
    return tuple(
        replace(each.opening, id=place, shape=numbers.setdefault((each.opening.plane, each.opening.shape), place))
        for place, each in enumerate(placed)
    )
