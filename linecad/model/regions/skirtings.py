"""Plain walls of a room, of which nothing shows but where they meet the floor.

A wall without a picture or a door has no line of its own: floor and ceiling went on behind it, and the photo of the
wall was painted on the floor. But its skirting is a line on the floor, and nothing lies farther off on that side.
"""

import numpy as np

from linecad.arrays import Float
from linecad.directions import UP, Turns, components, directions_of, partner
from linecad.geometry import lengths
from linecad.model.regions.surfaces import RELIEF, Surface, apart
from linecad.scene import Camera, Lines

LEAST_LENGTH = 0.1  # of the photo's width, of the lines of a skirting together
AT_FLOOR = 0.04  # log height within which a line is on the floor: a skirting's upper edge is too


def with_skirtings(surfaces: list[Surface], lines: Lines, camera: Camera, turns: Turns) -> list[Surface]:
    """The surfaces of a room, and behind them a plain wall on each side that has none but a skirting.

    `turns` are those of further frames. A room without a floor gets none.
    """
    floor = next((surface.offset for surface in surfaces if surface.kind == "ground"), None)
    if floor is None:
        return surfaces
    ends = components(lines.ends, turns)
    top = next((surface.offset for surface in surfaces if surface.kind == "ceiling"), float(ends[:, :, UP].max()))
    height = ends[:, 0, UP]
    is_on_floor = (height < 0) & (np.abs(np.log(np.where(height < 0, height / floor, 1.0))) < AT_FLOOR)
    length = lengths(np.diff(lines.segment, axis=1)[:, 0]) / camera.width
    found = []
    for along in (axis for axis in range(len(directions_of(turns))) if axis != UP):
        normal = int(partner(along))
        own = (lines.axis == along) & is_on_floor
        for side in (1.0, -1.0):
            if any(each.kind == "wall" and each.axis == normal and side * each.offset > 0 for each in surfaces):
                continue
            offset = _last_of(ends[own, 0, normal], length[own], side)
            if offset is None:
                continue
            is_it = own & np.array([apart(each, offset) < RELIEF for each in ends[:, 0, normal].tolist()], bool)
            box = np.full((2, ends.shape[2]), offset)
            box[:, UP] = floor, top
            reach = ends[is_it, :, along]
            box[:, along] = min(0.0, reach.min()), max(0.0, reach.max())  # a photo shows no foot beside the camera
            found.append(Surface("wall", normal, offset, np.zeros(0, np.int64), None, box))
    return [*surfaces, *found]


def _last_of(offset: Float, length: Float, side: float) -> float | None:
    """The farthest offset on one side at which lines, of offsets (M,), are long enough together; None for none."""
    for each in sorted((number for number in offset.tolist() if side * number > 0), key=abs, reverse=True):
        if length[[apart(other, each) < RELIEF for other in offset.tolist()]].sum() >= LEAST_LENGTH:
            return float(each)
    return None
