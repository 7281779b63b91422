"""What a line looks like that a person draws, turns, splits or joins: it passes through its axis's vanishing point."""

import numpy as np

from linecad.arrays import Float
from linecad.corrections.edits import Point
from linecad.directions import axis_name
from linecad.errors import CorrectionError
from linecad.geometry import PhotoLength, angles_to, directions_to, vanishing_points
from linecad.line_graph import ManhattanFrame
from linecad.scene import Camera

JOIN_ACROSS = PhotoLength(20.0, floor=6.0)  # between two pieces of one line
SHORTEST_PIECE = PhotoLength(25.0, floor=10.0)  # shorter lines take no part in the line graph


class Drawing:
    """The rules for lines of one photo; segments are (2, 2) px."""

    def __init__(self, camera: Camera, frame: ManhattanFrame) -> None:
        self.width = camera.width
        self.vanishing = vanishing_points(camera.matrix, frame.axes)
        self.shortest = SHORTEST_PIECE.px(camera.width)  # px below which a segment is no line of the graph

    def long_enough(self, ends: Float) -> Float:
        """The same segment; CorrectionError when it is too short to be a line."""
        length = float(np.linalg.norm(ends[1] - ends[0]))
        if length < self.shortest:
            raise CorrectionError(f"a line of {length:.0f} px is too short; at least {self.shortest:.0f} px are needed")
        return ends

    def nearest_axis(self, ends: Float) -> int:
        """The axis whose vanishing point a segment points to best."""
        return int(angles_to(ends[None], self.vanishing)[:, 0].argmin())

    def turned(self, ends: Float, axis: int) -> Float:
        """A segment turned about its middle to pass through the vanishing point of an axis."""
        return self.through(ends.mean(axis=0), ends, axis)

    def off_axes(self, ends: Float) -> Float:
        """(K,) rad between a segment and the line from its middle to the vanishing point of each axis."""
        angles: Float = np.arcsin(np.minimum(angles_to(ends[None], self.vanishing)[:, 0], 1.0))
        return angles

    def reaching(self, ends: Float, wanted: Float) -> Float:
        """The part of a segment's own line between the feet of two places (2, 2), in the direction of the segment.

        CorrectionError when it is too short to be a line.
        """
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        places = np.sort((wanted - ends[0]) @ along)
        reached: Float = ends[0] + places[:, None] * along
        return self.long_enough(reached)

    def split(self, ends: Float, at: Point) -> tuple[Float, Float]:
        """The two pieces of a segment that meet at the foot of a point; CorrectionError when one is too short."""
        along = ends[1] - ends[0]
        place = float((np.array(at) - ends[0]) @ along / (along @ along))
        if min(place, 1 - place) * float(np.linalg.norm(along)) < self.shortest:
            raise CorrectionError(
                f"a piece would be shorter than {self.shortest:.0f} px, too short to be a line; split nearer the middle"
            )
        point = ends[0] + place * along
        return np.array([ends[0], point]), np.array([point, ends[1]])

    def joined(self, one: Float, other: Float, axis: int) -> Float:
        """The segment that covers two of one axis; CorrectionError when they lie too far beside each other."""
        length = np.array([np.linalg.norm(ends[1] - ends[0]) for ends in (one, other)])
        middle = np.average([ends.mean(axis=0) for ends in (one, other)], axis=0, weights=length)
        along = directions_to(middle, self.vanishing[axis])
        points = np.concatenate([one, other]) - middle
        across = float(np.abs(points @ np.array([-along[1], along[0]])).max())
        allowed = JOIN_ACROSS.px(self.width)
        if across > allowed:
            raise CorrectionError(
                f"the two lines are {across:.0f} px beside each other, pieces of one line at most {allowed:.0f} px; "
                "choose two pieces of one line"
            )
        reach = points @ along
        whole: Float = middle + np.array([[reach.min()], [reach.max()]]) * along
        return whole

    def through(self, point: Float, ends: Float, axis: int, held: int | None = None) -> Float:
        """The segment on the line from a point (2,) to a vanishing point that reaches as far as `ends` do.

        `held`: the end that the point is.
        """
        if axis >= len(self.vanishing):
            raise CorrectionError(f"the photo has no direction {axis_name(axis)}; choose another axis")
        along = directions_to(point, self.vanishing[axis])
        span = ends[1] - ends[0]
        length = float(np.linalg.norm(span))
        if along @ span < 0:
            along = -along
        # What is turned far keeps its length; what is turned little keeps the feet of its ends.
        reach = (ends - point) @ along
        if reach[1] - reach[0] < length / 2:
            reach = length * (np.array([-0.5, 0.5]) if held is None else np.array([0.0, 1.0]) - held)
        moved: Float = point + reach[:, None] * along
        return moved
