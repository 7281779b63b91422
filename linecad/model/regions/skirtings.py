"""Plain walls of a room, of which little shows but where they meet the floor.

A wall without a picture or a door has no line of its own: floor and ceiling went on behind it, and the photo of the
wall was painted on the floor. But its skirting is a line on the floor, and nothing lies farther off on that side. Where
the wall has lines at one end only, as of a door frame, the rest of it is told by its skirting.
"""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, Turns, components, directions_of, partner
from linecad.geometry import lengths
from linecad.model.regions.surfaces import RELIEF, Surface, apart, box_of, weights_of
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
    turns: Turns
    axis: Int  # (N,) of its lines
    ends: Float  # (N, 2, K) components of their ends
    length: Float  # (N,) of the photo's width
    weight: Float  # (N,) the same, less where their place is unsure
    on_floor: Bool  # (N,)

    def last_wall(self, normal: int, side: float) -> int | None:
        """Which of the surfaces is the farthest wall on one side."""
        there = [number for number, each in enumerate(self.surfaces)
                 if each.kind == "wall" and each.axis == normal and side * each.offset > 0]  # fmt: skip
        return max(there, key=lambda number: abs(self.surfaces[number].offset), default=None)

    def plain_wall(self, along: int, side: float) -> Surface | None:
        """A wall without lines over the farthest skirting along an axis on one side; None where there is none."""
        normal = int(partner(along))
        if not any(each.kind == "wall" and each.axis in (along, normal) for each in self.surfaces):
            return None  # a frame without walls may be that of a table
        group = self._last(np.flatnonzero((self.axis == along) & self.on_floor), side, normal)
        box = None if group is None else self._box(group, side, along)
        return None if box is None else Surface("wall", normal, float(box[0, normal]), np.zeros(0, np.int64), None, box)

    def over_skirting(self, wall: Surface, along: int, side: float) -> Surface:
        """A wall as far as its skirting reaches, up to the ceiling: what is plain there is seen of it too."""
        group = self._at(np.flatnonzero((self.axis == along) & self.on_floor), wall.offset, wall.axis)
        box = None if group is None else self._box(group, side, along)
        if box is None:
            return wall
        reach = np.concatenate([box[:, along], box_of(wall, self.ends)[:, along]])
        return replace(wall, box=self._corners(along, _range(reach), wall.offset))

    def _box(self, group: Int, side: float, along: int) -> Float | None:
        """Low and high components (2, K) of the wall over a skirting of these lines; None where that is of no wall."""
        normal = int(partner(along))
        longest = group[int(self.length[group].argmax())]
        offset, reach = float(self.ends[longest, 0, normal]), self.ends[group, :, along]
        farther = (side * self.ends[:, :, normal]).max(axis=1) > BEYOND * abs(offset)
        if abs(offset) < -NEAREST * self.floor or self.weight[farther].sum() > MOST_BEYOND * self.weight.sum():
            return None
        low, high = _range(reach)
        if max(abs(low), abs(high)) > abs(offset):  # it runs towards the camera, beside which a photo shows no foot
            low, high = min(low, 0.0), max(high, 0.0)
        return self._corners(along, (low, high), offset)

    def _corners(self, along: int, reach: tuple[float, float], offset: float) -> Float:
        """Low and high components (2, K) of a wall from floor to ceiling."""
        axes = directions_of(self.turns)
        foot = np.outer(reach, axes[along]) + offset * axes[int(partner(along))]
        corners = components(foot[:, None] + np.outer((self.floor, self.ceiling), axes[UP]), self.turns)
        return np.stack([corners.min(axis=(0, 1)), corners.max(axis=(0, 1))])

    def _last(self, rows: Int, side: float, normal: int) -> Int | None:
        """Those of some lines that are farthest off on a side and at one place, and long enough together."""
        offset = self.ends[rows, 0, normal]
        for place in sorted(offset[side * offset > 0].tolist(), key=abs, reverse=True):
            group = self._at(rows, place, normal)
            if group is not None:
                return group
        return None

    def _at(self, rows: Int, place: float, normal: int) -> Int | None:
        """Those of some lines that are at one place, None where they are not long enough together."""
        own = rows[[apart(offset, place) < RELIEF for offset in self.ends[rows, 0, normal].tolist()]]
        return own if self.length[own].sum() >= LEAST_LENGTH else None


def _range(values: Float) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def with_skirtings(surfaces: list[Surface], lines: Lines, camera: Camera, turns: Turns) -> list[Surface]:
    """The surfaces of a room, walls as far as their skirtings reach; behind them plain ones that have no other line.

    `turns` are those of further frames. What has no floor or no ceiling is no room, and gets none.
    """
    level = {surface.kind: surface.offset for surface in surfaces if surface.kind in ("ground", "ceiling")}
    if len(level) < 2:
        return surfaces
    ends = components(lines.ends, turns)
    on_floor = np.array([apart(height, level["ground"]) < AT_FLOOR for height in ends[:, 0, UP].tolist()], bool)
    length = lengths(np.diff(lines.segment, axis=1)[:, 0]) / camera.width
    weight = weights_of(lines) / camera.width
    axis = np.asarray(lines.axis)
    room = _Room(surfaces, level["ground"], level["ceiling"], turns, axis, ends, length, weight, on_floor)
    axes = [axis for axis in range(ends.shape[2]) if axis != UP]
    found, new = list(surfaces), []
    for along, side in product(axes, (1.0, -1.0)):
        number = room.last_wall(int(partner(along)), side)
        if number is None:
            new.append(room.plain_wall(along, side))
        else:
            found[number] = room.over_skirting(surfaces[number], along, side)
    return [*found, *filter(None, new)]
