"""Which face the photo shows where."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Float, Int
from linecad.directions import Turns, components
from linecad.geometry import PhotoLength, project, unit_normals, world_rays
from linecad.scene import Camera, Face, Plane

NO_FACE = -1
BESIDE = PhotoLength(6.0, floor=3.0)  # px to either side of a line, where what it lies on is looked at


@dataclass(frozen=True, eq=False)
class SeenFaces:
    """F faces as the photo shows them, each without what hides it; no place shows two."""

    plane: tuple[Plane, ...]  # F
    face: tuple[Face, ...]  # F
    polygon: NDArray[np.object_]  # (F,) px
    hidden: NDArray[np.object_]  # (F,) px, what things before the faces hide of them
    camera: Camera
    axes: Float  # (3, K) directions in the camera frame
    turns: Turns = ()  # of further frames

    @classmethod
    def of(cls, planes: tuple[Plane, ...], camera: Camera, rotation: Float, turns: Turns = ()) -> "SeenFaces":
        """Those of all planes; `rotation` (3, 3) takes world to camera, `turns` are of further frames."""
        faces = [(plane, face) for plane in planes for face in plane.faces]
        shapes = np.array([_shown(face, camera, rotation) for _, face in faces], object).reshape(-1, 2)
        shapely.prepare(shapes)
        planes, shown = (tuple(each) for each in zip(*faces, strict=True)) if faces else ((), ())
        return cls(planes, shown, shapes[:, 0], shapes[:, 1], camera, components(rotation, turns), turns)

    def at(self, pixels: Float) -> Int:
        """The face (M,) that each pixel (M, 2) shows, NO_FACE for none."""
        return _which(self.polygon, pixels)

    def hidden_at(self, pixels: Float) -> Int:
        """The face (M,) that a thing hides at each pixel (M, 2), NO_FACE for none."""
        return _which(self.hidden, pixels)

    @property
    def axis(self) -> Int:
        """(F + 1,) the normal of each face; -1 at the end, for NO_FACE."""
        return np.array([*(plane.axis for plane in self.plane), -1])

    def depths(self, face: Int, pixels: Float) -> Float:
        """Camera depth (M,) of the plane of each face (M,) at a pixel (M, 2); infinite for NO_FACE."""
        offset = np.array([*(plane.offset for plane in self.plane), np.nan])
        normal = np.maximum(self.axis[face], 0)
        rays = world_rays(pixels, self.camera.matrix, self.axes)[np.arange(len(pixels)), normal]
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = offset[face] / rays
        return np.where(depth > 0, depth, np.inf)

    def beside(self, pixels: Float, along: Float) -> tuple[Int, Int]:
        """The faces (M,) on both sides of lines that run through pixels (M, 2) in directions (M, 2)."""
        across = BESIDE.px(self.camera.width) * unit_normals(along)
        return self.at(pixels + across), self.at(pixels - across)


def _shown(face: Face, camera: Camera, rotation: Float) -> tuple[shapely.Geometry, shapely.Geometry]:
    """What the photo shows of a face, and what it does not for a thing before it, px."""
    outline, *others = (project(ring, camera.matrix, rotation) for ring in (face.outline, *face.holes, *face.hidden))
    holes, hidden = others[: len(face.holes)], _union(others[len(face.holes) :])
    whole = shapely.make_valid(shapely.Polygon(outline, holes))
    if not face.hidden:
        return whole, hidden
    # A ring around an opening covers it, though what is seen there is its pane.
    return shapely.difference(whole, hidden), shapely.difference(hidden, _union(holes))


def _union(rings: list[Float]) -> shapely.Geometry:
    return shapely.union_all([shapely.make_valid(shapely.Polygon(ring)) for ring in rings])


def _which(polygons: NDArray[np.object_], pixels: Float) -> Int:
    found = np.full(len(pixels), NO_FACE)
    for number, polygon in enumerate(polygons):
        found[shapely.contains_xy(polygon, pixels)] = number
    return found
