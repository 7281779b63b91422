"""The rectangles that openings cut out of walls, and the wall that each is in."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from exporters.faces import FlatFace, Frame
from exporters.model import Model, metres_per_unit
from exporters.openings import Fitting
from linecad.arrays import Float
from linecad.directions import directions_of, partner
from linecad.scene import Opening

_TOUCHING = 1e-6  # m; borders that are nearer are one
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Side:
    """Axes of an upright face: x along it, to the right as it is looked at, y away from who looks, z up."""

    origin: Float  # (3,) m, its lower left corner
    along: Float  # (3,) unit, x
    away: Float  # (3,) unit, y

    @classmethod
    def of(cls, face: FlatFace) -> "Side":
        """The axes of an upright face."""
        along = np.cross(_UP, face.normal)
        points = face.rings[0]
        lowest, leftmost = points[:, 2].min(), points[(points @ along).argmin()]
        return cls(np.array([*leftmost[:2], lowest]), along, -face.normal)

    def flat(self, points: Float) -> Float:
        """(..., 2) m, x and z of points (..., 3) of the world."""
        from_origin = points - self.origin
        return np.stack([from_origin @ self.along, from_origin[..., 2]], axis=-1)

    def polygon(self, face: FlatFace) -> shapely.Polygon:
        """A face in these axes."""
        outline, *holes = map(self.flat, face.rings)
        return shapely.Polygon(outline, holes)


@dataclass(frozen=True, eq=False)
class Void:
    """The rectangle of an opening in the plane of its wall."""

    fitting: Fitting
    opening: Opening
    plane: int  # id of the wall's plane
    low: Float  # (3,) m, the corner where u and v are least
    high: Float  # (3,) m, the opposite corner
    recess: float  # m, from the wall to the pane; 0 where nothing tells it

    def rectangle(self, side: Side) -> tuple[Float, Float]:
        """Its lower left and upper right corner, (2,) m each, in the axes of its wall."""
        corners = side.flat(np.stack([self.low, self.high]))
        return corners.min(axis=0), corners.max(axis=0)

    def box(self, side: Side) -> shapely.Polygon:
        """The same as a polygon."""
        low, high = self.rectangle(side)
        return shapely.box(*low.tolist(), *high.tolist())


def build_voids(model: Model) -> tuple[Void, ...]:
    """Of every opening that has faces, in ascending id."""
    scene, metres = model.scene, metres_per_unit(model.scene)
    frame = Frame(metres, model.eye, directions_of(scene.turns), scene.turns)
    planes, openings = {plane.id: plane for plane in scene.planes}, {each.id: each for each in scene.openings}
    made = []
    for fitting in model.fittings:
        opening = openings[fitting.id]
        plane = planes[opening.plane]
        across, along = frame.directions[plane.axis], frame.directions[int(partner(plane.axis))]
        low, high = (
            frame(plane.offset * across + u * along + v * _UP)
            for u, v in ((opening.u0, opening.v0), (opening.u1, opening.v1))
        )
        made.append(Void(fitting, opening, plane.id, low, high, (opening.recess or 0.0) * metres))
    return tuple(made)


def host_of(void: Void, walls: Sequence[tuple[FlatFace, Side]]) -> int | None:
    """The id of the face that an opening is cut out of: that with the most border in common; None where none has any.

    A window is a hole of its wall; a door that stands on the foot of the wall is a part of its outline.
    """
    shared = {}
    for face, side in walls:
        if face.plane == void.plane:
            common = shapely.intersection(side.polygon(face).boundary, void.box(side).boundary, grid_size=_TOUCHING)
            shared[face.id] = float(common.length)
    best = max(shared, key=lambda number: (shared[number], -number), default=None)
    return best if best is not None and shared[best] > _TOUCHING else None
