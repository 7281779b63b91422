"""Plain walls of a room, of which nothing shows but where they meet the floor.

A wall without a picture or a door has no line of its own: floor and ceiling went on behind it, and the photo of the
wall was painted on the floor. But its skirting is a line on the floor, and nothing lies farther off on that side.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, Turns, components, partner
from linecad.geometry import lengths
from linecad.model.regions.surfaces import RELIEF, Surface, apart, weights_of
from linecad.scene import Camera, Lines

LEAST_LENGTH = 0.1  # of the photo's width, of the lines of a skirting together
# Log height within which a line is on the floor: a skirting's upper edge is too. Few lines that stand wrong are there
# by chance, so that it counts for nothing here how sure each one is.
AT_FLOOR = 0.04
NEAREST = 0.2  # of the camera's height; a line on the floor that is nearer beside the camera has no wall above it
BEYOND = 1.03  # times its distance; a line that reaches farther on that side lies behind it
MOST_BEYOND = 0.02  # of all lines, by length and how sure they are, may do so: a pane shows what is behind


@dataclass(frozen=True, eq=False)
class _Room:
    """What is known of a room."""

    surfaces: list[Surface]
    floor: float  # offset
    ceiling: float
    axis: Int  # (N,) of its lines
    ends: Float  # (N, 2, K) components of their ends
    length: Float  # (N,) of the photo's width
    weight: Float  # (N,) the same, less where their place is unsure
    on_floor: Bool  # (N,)

    def skirting(self, along: int, side: float) -> Surface | None:
        """The wall over the farthest skirting along an axis on one side; None where there is none, or another wall."""
        normal = int(partner(along))
        walls = [each for each in self.surfaces if each.kind == "wall" and each.axis in (along, normal)]
        is_walled = any(each.axis == normal and side * each.offset > 0 for each in walls)
        if is_walled or not walls:  # a frame without walls may be that of a table
            return None
        group = self._last(np.flatnonzero((self.axis == along) & self.on_floor), side, normal)
        if group is None:
            return None
        longest = group[int(self.length[group].argmax())]
        offset, reach = float(self.ends[longest, 0, normal]), self.ends[group, :, along]
        farther = (side * self.ends[:, :, normal]).max(axis=1) > BEYOND * abs(offset)
        if abs(offset) < -NEAREST * self.floor or self.weight[farther].sum() > MOST_BEYOND * self.weight.sum():
            return None
        low, high = float(reach.min()), float(reach.max())
        if max(abs(low), abs(high)) > abs(offset):  # it runs towards the camera, beside which a photo shows no foot
            low, high = min(low, 0.0), max(high, 0.0)
        box = np.full((2, self.ends.shape[2]), offset)
        box[:, UP], box[:, along] = (self.floor, self.ceiling), (low, high)
        return Surface("wall", normal, offset, np.zeros(0, np.int64), None, box)

    def _last(self, rows: Int, side: float, normal: int) -> Int | None:
        """Those of some lines that are farthest off on a side and at one place, and long enough together."""
        offset = dict(zip(rows.tolist(), self.ends[rows, 0, normal].tolist(), strict=True))
        for row in sorted(offset, key=lambda each: -side * offset[each]):
            group = np.array([each for each in offset if apart(offset[each], offset[row]) < RELIEF], np.int64)
            if side * offset[row] > 0 and self.length[group].sum() >= LEAST_LENGTH:
                return group
        return None


def with_skirtings(surfaces: list[Surface], lines: Lines, camera: Camera, turns: Turns) -> list[Surface]:
    """The surfaces of a room, and behind them a plain wall on each side that has none but a skirting.

    `turns` are those of further frames. What has no floor or no ceiling is no room, and gets none.
    """
    level = {surface.kind: surface.offset for surface in surfaces if surface.kind in ("ground", "ceiling")}
    if len(level) < 2:
        return surfaces
    ends = components(lines.ends, turns)
    on_floor = np.array([apart(height, level["ground"]) < AT_FLOOR for height in ends[:, 0, UP].tolist()], bool)
    length = lengths(np.diff(lines.segment, axis=1)[:, 0]) / camera.width
    weight = weights_of(lines) / camera.width
    room = _Room(surfaces, level["ground"], level["ceiling"], np.asarray(lines.axis), ends, length, weight, on_floor)
    axes = [axis for axis in range(ends.shape[2]) if axis != UP]
    found = [room.skirting(along, side) for along in axes for side in (1.0, -1.0)]
    return [*surfaces, *filter(None, found)]
