"""Faces of openings: a hole in the wall, the pane in it and, where the pane is known to be deeper, the reveals between.

A pane at the wall's own depth shares the corners of its hole, so that the wall stays whole. What the photo cannot show,
since the wall or a thing before it hides it, is told as hidden.
"""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from linecad.arrays import Float
from linecad.directions import UP, Turns, partner
from linecad.model.openings.corners import flat_on_wall, on_wall, panel_in_space, rectangle_in_space
from linecad.scene import Face, FaceKind, Opening, Plane

MARGIN = 0.01  # of an opening's shorter side: nearer to the outline, to another opening or to a hole it is not cut
STEP = 0.15  # of a door's height, by which its foot may be off the edge that it stands on
LEAST_HIDDEN = 0.01  # of a face; smaller hidden parts are not worth a ring


@dataclass(frozen=True, eq=False)
class _Cut:
    """An opening that is cut out of a wall."""

    wall: Plane
    face: Face  # of the wall
    opening: Opening
    turns: Turns


def with_openings(
    planes: tuple[Plane, ...], openings: tuple[Opening, ...], turns: Turns = ()
) -> tuple[tuple[Plane, ...], tuple[Opening, ...]]:
    """The planes with the faces of openings, and the openings, whose doors now stand on the foot of their wall.

    New faces and planes count on from the ids that are there. An opening that is not wholly inside a face of its wall,
    or that meets another, is not cut. `turns` are those of the frames beside the main one.
    """
    cuts: list[_Cut] = []
    changed: dict[int, Face] = {}
    standing = list(openings)
    for place, opening in enumerate(openings):
        wall = next(plane for plane in planes if plane.id == opening.plane)
        for face in wall.faces:
            standing_on = _on_foot(opening, face, wall, turns) if opening.kind == "door" else None
            cut = opening if standing_on is None else standing_on
            opened = _opened(changed.get(face.id, face), wall, cut, standing_on is not None, turns)
            if opened is not None:
                changed[face.id] = opened
                standing[place] = cut
                cuts.append(_Cut(wall, face, cut, turns))
                break
    found = [replace(plane, faces=tuple(changed.get(face.id, face) for face in plane.faces)) for plane in planes]
    return _with_faces(found, cuts), _with_shapes(openings, standing)


def _on_foot(opening: Opening, face: Face, wall: Plane, turns: Turns) -> Opening | None:
    """A door with its foot on the level edge of the outline that it nearly stands on; None where there is none."""
    outline = flat_on_wall(face.outline, wall.axis, turns)
    following = np.roll(outline, -1, axis=0)
    level = outline[:, 1] == following[:, 1]
    beside = (np.minimum(outline[:, 0], following[:, 0]) < opening.u0) & (
        np.maximum(outline[:, 0], following[:, 0]) > opening.u1
    )
    near = np.abs(outline[:, 1] - opening.v0) <= STEP * (opening.v1 - opening.v0)
    feet = outline[level & beside & near, 1]
    if not len(feet):
        return None
    return replace(opening, v0=float(feet[np.abs(feet - opening.v0).argmin()]))


def _opened(face: Face, wall: Plane, opening: Opening, stands: bool, turns: Turns) -> Face | None:
    """A face with an opening cut out of it, which `stands` on an edge of the outline or is inside; else None."""
    rings = [flat_on_wall(ring, wall.axis, turns) for ring in (face.outline, *face.holes)]
    whole = shapely.Polygon(rings[0], rings[1:])
    rectangle = shapely.box(opening.u0, opening.v0, opening.u1, opening.v1)
    if not whole.covers(rectangle):
        return None
    margin = MARGIN * min(opening.u1 - opening.u0, opening.v1 - opening.v0)
    upper = shapely.box(opening.u0, opening.v0 + margin, opening.u1, opening.v1) if stands else rectangle
    if whole.boundary.distance(upper) < margin * (1 - 1e-9):
        return None
    hidden = _outside(face.hidden, rectangle, wall, turns)
    if not stands:
        return replace(face, holes=(*face.holes, rectangle_in_space(opening, wall, turns)), hidden=hidden)
    left = shapely.difference(whole, rectangle)
    if not isinstance(left, shapely.Polygon) or len(left.interiors) != len(face.holes):
        return None
    outline = _lifted(left.exterior, wall, turns)
    # Corners that stay are those of the neighbours, to the last digit, which there and back they would not be.
    row, corner = np.nonzero((shapely.get_coordinates(left.exterior)[:-1, None] == rings[0]).all(axis=2))
    outline[row] = face.outline[corner]
    return replace(face, outline=outline, hidden=hidden)


def _lifted(ring: shapely.LinearRing, wall: Plane, turns: Turns) -> Float:
    """The points (V, 3) of a ring in a wall."""
    return on_wall(shapely.get_coordinates(ring)[:-1], wall.axis, wall.offset, turns)


def _outside(hidden: tuple[Float, ...], rectangle: shapely.Polygon, wall: Plane, turns: Turns) -> tuple[Float, ...]:
    """Hidden parts (V, 3) of a wall without what lies in an opening; those that go all around it stay as they are."""
    kept: list[Float] = []
    for ring in hidden:
        part = shapely.make_valid(shapely.Polygon(flat_on_wall(ring, wall.axis, turns)))
        if not part.intersects(rectangle):
            kept.append(ring)
            continue
        left = shapely.get_parts(shapely.difference(part, rectangle))
        polygons = [each for each in left if isinstance(each, shapely.Polygon) and not each.is_empty]
        kept += [_lifted(each.exterior, wall, turns) for each in polygons]
    return tuple(kept)


def _with_faces(planes: list[Plane], cuts: list[_Cut]) -> tuple[Plane, ...]:
    """The planes with panes and reveals, new planes last."""
    face_id = max((face.id for plane in planes for face in plane.faces), default=-1) + 1
    place = {(plane.axis, plane.offset): number for number, plane in reversed(list(enumerate(planes)))}
    place |= {(plane.axis, plane.offset): number for number, plane in enumerate(planes) if plane.faces}
    for cut in cuts:
        for axis, offset, face in _faces_of(cut):
            number = place.setdefault((axis, offset), len(planes))
            if number == len(planes):
                planes.append(Plane(max(plane.id for plane in planes) + 1, axis, offset, ()))
            planes[number] = replace(planes[number], faces=(*planes[number].faces, replace(face, id=face_id)))
            face_id += 1
    return tuple(planes)


def _faces_of(cut: _Cut) -> list[tuple[int, float, Face]]:
    """Pane and reveals of an opening: the axis and offset of the plane, and the face, each with id 0."""
    opening, wall, turns = cut.opening, cut.wall, cut.turns
    hole, deep = rectangle_in_space(opening, wall, turns), panel_in_space(opening, wall, turns)
    if deep is None or opening.panel is None:
        rectangle = shapely.Polygon(flat_on_wall(hole, wall.axis, turns))
        rings = [flat_on_wall(ring, wall.axis, turns) for ring in cut.face.hidden]
        parts = [shapely.make_valid(shapely.Polygon(ring)) for ring in rings]
        shared = [shapely.intersection(part, rectangle) for part in parts]
        return [(wall.axis, wall.offset, _face(hole, opening.kind, opening, _rings(shared, rectangle, wall, turns)))]
    behind = replace(wall, offset=opening.panel)
    hidden = _hidden_by_wall(deep, opening, behind, turns)
    found = [(wall.axis, behind.offset, _face(deep, opening.kind, opening, hidden))]
    # Sill, right, head, left: the sides of the hole in the order of its corners.
    for side, offset in enumerate((opening.v0, opening.u1, opening.v1, opening.u0)):
        other = (side + 1) % 4
        ring = np.array([hole[side], hole[other], deep[other], deep[side]])
        axis = UP if side in (0, 2) else int(partner(wall.axis))
        # The camera, which is the origin, sees the side that looks inwards.
        is_seen = (offset < 0) == (side in (0, 3))
        found.append((axis, offset, _face(ring, "reveal", opening, () if is_seen else (ring,))))
    return found


def _hidden_by_wall(deep: Float, opening: Opening, behind: Plane, turns: Turns) -> tuple[Float, ...]:
    """The parts (V, 3) of a pane that are not seen through its hole."""
    pane = shapely.Polygon(flat_on_wall(deep, behind.axis, turns))
    hole = shapely.box(opening.u0, opening.v0, opening.u1, opening.v1)
    assert opening.recess is not None
    ratio = abs(behind.offset) / (abs(behind.offset) - opening.recess)
    seen = shapely.transform(hole, lambda points: points * ratio)
    return _rings([shapely.difference(pane, seen)], pane, behind, turns)


def _rings(parts: list[shapely.Geometry], whole: shapely.Polygon, plane: Plane, turns: Turns) -> tuple[Float, ...]:
    """The outlines (V, 3) of parts of a face that are large enough."""
    polygons = [each for part in parts for each in shapely.get_parts(part) if isinstance(each, shapely.Polygon)]
    return tuple(_lifted(each.exterior, plane, turns) for each in polygons if each.area >= LEAST_HIDDEN * whole.area)


def _face(ring: Float, kind: FaceKind, opening: Opening, hidden: tuple[Float, ...]) -> Face:
    return Face(0, ring, (), kind, hidden, opening.id)


def _with_shapes(before: tuple[Opening, ...], openings: list[Opening]) -> tuple[Opening, ...]:
    """The openings with a shape of their own for those of a shape whose height changed."""
    numbers: dict[tuple[int, float], int] = {}
    found = []
    for old, new in zip(before, openings, strict=True):
        shape = numbers.setdefault((old.shape, new.v0 - old.v0), new.id)
        found.append(replace(new, shape=shape))
    return tuple(found)
