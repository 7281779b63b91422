"""What is known exactly about a made photo: the camera, every quad and edge of the scene, what each pixel shows.

World frame: the scene's Manhattan axes, z up, in metres, origin at the camera's centre. Camera frame: x right, y down,
z forward. Pixels: the centre of the first one is (0, 0), x right, y down.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int

NOTHING = -1  # in the id map: the sky


@dataclass(frozen=True, eq=False)
class TrueOpenings:
    """The O windows and doors of a made scene, seen or not."""

    corners: Float  # (O, 4, 3) of the holes, in the walls' planes, m, in order around
    is_door: Bool  # (O,)
    body: Int  # (O,) the building that has it


@dataclass(frozen=True, eq=False)
class TrueFrames:
    """The F horizontal frames of a scene of several: two level directions at right angles, and the vertical.

    They are in the order of the pixels of their walls; the first one has the axes of the world.
    """

    turn: Float  # (F,) rad from the world's x axis to one of the frame's, counterclockwise from above, -pi/4 to pi/4
    quad: Int  # (Q,) the frame in which a quad's level direction lies; NOTHING for level quads and those in no frame
    quad_slope: Float  # (Q,) rad between the quad and the horizontal: 0 for the ground, pi / 2 for walls
    edge: Int  # (M,) the frame of an edge that is level, or whose plan is an axis of it; NOTHING for upright ones
    edge_slope: Float  # (M,) rad above the horizontal, 0 to pi / 2


@dataclass(frozen=True, eq=False)
class Truth:
    """The ground truth of one made photo of Q quads and M edges, V visible pieces of edges."""

    name: str  # of the scene, such as street-0007
    width: int  # px
    height: int  # px
    matrix: Float  # (3, 3) K, px
    rotation: Float  # (3, 3) world to camera
    quads: Float  # (Q, 4, 3) corners of planar parallelograms and triangles, m, in order around
    body: Int  # (Q,) which body (a building, a car) a quad belongs to
    edges: Float  # (M, 2, 3) both ends of each straight edge of the scene, hidden or not, m
    edge_body: Int  # (M,)
    pieces: Float  # (V, 2, 2) px, ends of the visible pieces of edges, inside the photo
    piece_edge: Int  # (V,) the edge that each piece shows
    ids: Int  # (H, W) the quad that the centre of each pixel shows, or NOTHING
    openings: TrueOpenings | None = None  # None in scenes that were made before they were told
    frames: TrueFrames | None = None  # None where the world's axes are the only ones

    def planes(self) -> tuple[Float, Float]:
        """Unit normals (Q, 3) and offsets (Q,), m, of the quads: normal . P = offset."""
        return planes_of(self.quads)

    def rays(self, pixels: Float) -> Float:
        """World rays (N, 3) of camera depth 1 through pixels (N, 2)."""
        homogeneous = np.column_stack([pixels, np.ones(len(pixels))])
        rays: Float = homogeneous @ np.linalg.inv(self.matrix @ self.rotation).T
        return rays

    def quad_depth(self, pixels: Float, quads: Int) -> Float:
        """Camera depth (N,), m, at which the rays of pixels (N, 2) meet the planes of quads (N,); NaN for NOTHING."""
        normal, offset = self.planes()
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = offset[quads] / (normal[quads] * self.rays(pixels)).sum(axis=1)
        found: Float = np.where(quads == NOTHING, np.nan, depth)
        return found

    def quad_at(self, pixels: Float) -> Int:
        """The quads (N,) that the pixels nearest to (N, 2) show; NOTHING for the sky and outside the photo."""
        column, row = np.rint(pixels).astype(np.int64).T
        inside: Bool = (column >= 0) & (column < self.width) & (row >= 0) & (row < self.height)
        shown: Int = np.where(inside, self.ids[np.where(inside, row, 0), np.where(inside, column, 0)], NOTHING)
        return shown

    def depth(self) -> Float:
        """(H, W) camera depth of what each pixel's centre shows, m; NaN for the sky."""
        row, column = np.mgrid[: self.height, : self.width]
        pixels = np.column_stack([column.ravel(), row.ravel()]).astype(np.float64)
        return self.quad_depth(pixels, self.ids.ravel()).reshape(self.height, self.width)


def planes_of(quads: Float) -> tuple[Float, Float]:
    """Unit normals (Q, 3) and offsets (Q,), m, of quads (Q, 4, 3): normal . P = offset."""
    normal = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return normal, (normal * quads[:, 0]).sum(axis=1)
