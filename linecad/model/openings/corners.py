"""The corners of openings in space."""

import numpy as np

from linecad.arrays import Float
from linecad.scene import Opening, Plane


def rectangle_in_space(opening: Opening, plane: Plane) -> Float:
    """The corners (4, 3) of the hole in the wall's plane: from u0, v0 to u1, v0, u1, v1 and u0, v1, world.

    Every number is one of the opening's or the plane's own.
    """
    return _rectangle(opening, plane, plane.offset)


def panel_in_space(opening: Opening, plane: Plane) -> Float | None:
    """The same corners (4, 3) on the pane behind the wall; None where its depth is not known."""
    return None if opening.panel is None else _rectangle(opening, plane, opening.panel)


def _rectangle(opening: Opening, plane: Plane, offset: float) -> Float:
    u, v = (axis for axis in range(3) if axis != plane.axis)
    corners = np.empty((4, 3))
    corners[:, plane.axis] = offset
    corners[:, u] = [opening.u0, opening.u1, opening.u1, opening.u0]
    corners[:, v] = [opening.v0, opening.v0, opening.v1, opening.v1]
    return corners
