"""Openings on the walls that the photo shows around them.

An opening is found in the plane of the lines around it. Which surface a place of the photo shows is decided by the
labels of regions, which know more: then the opening goes where its rays meet that surface. On a parallel plane it stays
a rectangle, since the camera is the origin; on one at right angles it would be none, so the photo shows no opening. Nor
does it where something stands before the wall, unless an equal one is seen: the window of a tractor is none of the
house's, but one of a row behind a thin tree is.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.depth.normals import UNTOLD
from linecad.directions import Turns
from linecad.geometry import project
from linecad.model.openings.corners import rectangle_in_space
from linecad.scene import Camera, Opening, Plane

LEAST_SHARE = 0.5  # of an opening in the photo, which a face must show to be its wall
MOST_HIDDEN = 0.5  # of an opening that was seen


def at_home(
    openings: tuple[Opening, ...], planes: tuple[Plane, ...], camera: Camera, rotation: Float, turns: Turns = ()
) -> tuple[Opening, ...]:
    """The openings on the planes whose faces show them, with ids and shapes numbered anew.

    Openings that no face shows, such as those behind a tree beside the sky, stay where they are. Left out are those on
    a face that is not parallel to their plane, and those seen where the wall is hidden, unless one of their shape is
    seen where it is not; those that were hardly seen, of which rows and columns tell, stay there. `rotation` (3, 3)
    takes world to camera; `turns` are of further frames.
    """
    plane_of = {plane.id: plane for plane in planes}
    faces = [(plane, _polygon(face.outline, face.holes, camera, rotation)) for plane in planes for face in plane.faces]
    shapes = np.array([shape for _, shape in faces], object)
    hidden = [ring for plane in planes for face in plane.faces for ring in face.hidden]
    clutter = shapely.union_all([_polygon(ring, (), camera, rotation) for ring in hidden])
    seen = [
        shapely.Polygon(project(rectangle_in_space(each, plane_of[each.plane], turns), camera.matrix, rotation))
        for each in openings
    ]
    is_hidden = [
        not each.is_completed and clutter.intersection(shape).area > MOST_HIDDEN * shape.area
        for each, shape in zip(openings, seen, strict=True)
    ]
    in_sight = {
        (each.shape, each.plane)
        for each, hidden_one in zip(openings, is_hidden, strict=True)
        if not (hidden_one or each.is_completed)
    }
    kept: list[Opening] = []
    numbers: dict[tuple[int, int], int] = {}
    for opening, shape, hidden_one in zip(openings, seen, is_hidden, strict=True):
        wall = plane_of[opening.plane]
        if hidden_one and (opening.shape, opening.plane) not in in_sight:
            continue
        shared = shapely.area(shapely.intersection(shapes, shape)) if len(shapes) else np.zeros(0)
        if shared.max(initial=0.0) >= LEAST_SHARE * shape.area:
            home = faces[int(shared.argmax())][0]
            if home.axis != wall.axis or home.offset * wall.offset <= 0:
                continue
            opening = _moved(opening, wall, home)
        number = numbers.setdefault((opening.shape, opening.plane), len(kept))
        kept.append(replace(opening, id=len(kept), shape=number))
    return tuple(kept)


def axes_shown(planes: tuple[Plane, ...], camera: Camera, rotation: Float) -> Callable[[Float], Int]:
    """What tells the axis (N,) of the planes whose faces the photo shows at pixels (N, 2); UNTOLD where there is none.

    What stands before a face counts as the face.
    """
    axes = np.array([plane.axis for plane in planes for _ in plane.faces], np.int64)
    shapes = [_polygon(face.outline, face.holes, camera, rotation) for plane in planes for face in plane.faces]
    tree = shapely.STRtree(shapes)

    def axes_at(pixels: Float) -> Int:
        found = np.full(len(pixels), UNTOLD)
        point, face = tree.query(shapely.points(pixels), predicate="within")
        found[point] = axes[face]
        return found

    return axes_at


def _polygon(ring: Float, holes: tuple[Float, ...], camera: Camera, rotation: Float) -> shapely.Geometry:
    """A ring (V, 3) with its holes in the photo."""
    outline, *inner = (project(each, camera.matrix, rotation) for each in (ring, *holes))
    return shapely.make_valid(shapely.Polygon(outline, inner))


def _moved(opening: Opening, wall: Plane, home: Plane) -> Opening:
    """An opening of a wall as its rays meet a parallel plane; openings of one size stay so, but for rounding."""
    if home.id == wall.id:
        return opening
    ratio = home.offset / wall.offset
    u0, v0 = opening.u0 * ratio, opening.v0 * ratio
    recess = None if opening.recess is None else opening.recess * ratio
    return replace(
        opening,
        plane=home.id,
        u0=u0,
        u1=u0 + (opening.u1 - opening.u0) * ratio,
        v0=v0,
        v1=v0 + (opening.v1 - opening.v0) * ratio,
        recess=recess,
        panel=None if recess is None else home.offset + float(np.sign(home.offset)) * recess,
    )
