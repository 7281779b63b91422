"""The corners of openings in space."""

import numpy as np

from linecad.arrays import Float
from linecad.directions import MAIN, UP, Turns, components, directions_of, partner
from linecad.scene import Opening, Plane


def rectangle_in_space(opening: Opening, plane: Plane, turns: Turns = ()) -> Float:
    """The corners (4, 3) of the hole in the wall's plane: from u0, v0 to u1, v0, u1, v1 and u0, v1, world.

    Every number is one of the opening's or the plane's own where the plane is of the main frame; `turns` are those of
    further frames.
    """
    return _rectangle(opening, plane, plane.offset, turns)


def panel_in_space(opening: Opening, plane: Plane, turns: Turns = ()) -> Float | None:
    """The same corners (4, 3) on the pane behind the wall; None where its depth is not known."""
    return None if opening.panel is None else _rectangle(opening, plane, opening.panel, turns)


def _rectangle(opening: Opening, plane: Plane, offset: float, turns: Turns) -> Float:
    u, v = (opening.u0, opening.u1, opening.u1, opening.u0), (opening.v0, opening.v0, opening.v1, opening.v1)
    return on_wall(np.column_stack([u, v]), plane.axis, offset, turns)


def on_wall(flat: Float, axis: int, offset: float, turns: Turns) -> Float:
    """World points (V, 3) of points (V, 2), u and v, of a vertical plane of direction `axis` at `offset`."""
    if axis >= MAIN:
        vectors = directions_of(turns)
        found: Float = flat[:, :1] * vectors[partner(axis)] + offset * vectors[axis] + flat[:, 1:] * vectors[UP]
        return found
    points = np.empty((len(flat), 3))
    points[:, axis], points[:, 1 - axis], points[:, UP] = offset, flat[:, 0], flat[:, 1]
    return points


def flat_on_wall(points: Float, axis: int, turns: Turns) -> Float:
    """The horizontal coordinate u and the height v (V, 2) of points (V, 3) of a vertical plane of direction `axis`."""
    flat: Float = components(points, turns)[:, [int(partner(axis)), UP]]
    return flat


def rectangles_of(openings: tuple[Opening, ...], planes: tuple[Plane, ...]) -> Float | None:
    """Axis and offset of the wall, then u0, u1, v0, v1 of each opening, (W, 6); None where there is none."""
    wall = {plane.id: (plane.axis, plane.offset) for plane in planes}
    rows = [(*wall[each.plane], each.u0, each.u1, each.v0, each.v1) for each in openings if each.plane in wall]
    return np.array(rows) if rows else None
