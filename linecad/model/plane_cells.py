"""What lines and photo say about each plane: its cells, which of them may be wall, and how near its lines are.

A cell may be wall where lines close it in. A wall ends at its top line, so that no face reaches into the sky; where
lines on both sides go on above the photo, so does the wall between them.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.geometry import REFERENCE_WIDTH, project, world_rays
from linecad.model.outlines import Cells, Edges, build_cells
from linecad.scene import Camera, Lines, Plane

COLUMNS = 480  # of samples across the photo
SAME = 3.0  # px at the reference width; lines that are nearer are one line of an outline
ENDS_REACH = 12.0  # px at the reference width; an end so near to a line ends there
BORDER = 30.0  # px at the reference width; a line that ends so near to the photo's border goes on outside
BEHIND = 0.01  # relative depth by which a line is behind a plane for sure
SPEAKS = 12.0  # samples; a line behind says nothing about the wall further away from it
WALLS_OF_LEVEL = 4  # sides of a cell of a horizontal plane that lines close
WALLS = 2  # the same of a vertical plane, one of them the top, unless lines beside it go on above the photo
WEAK_FACTOR = 2.0  # by which a line of a smaller component must be nearer to win a pixel: its depth is a guess
NEAREST = 0.05  # of the middle depth; cells that reach nearer to the camera, or behind it, are none


@dataclass(frozen=True, eq=False)
class Samples:
    """Pixels at which faces are compared, and the same raster with the lines on it."""

    shape: tuple[int, int]
    step: float  # px
    rays: Float  # (S, 3)
    line: Int  # (T,) line of each point on lines
    cell: Int  # (T,) sample in which it lies
    line_rays: Float  # (T, 3)
    line_depth: Float  # (T,)

    def distance(self, points: Bool) -> Float:
        """Distance (S,) in samples to the nearest of the masked points on lines."""
        image = np.ones(self.shape[0] * self.shape[1], np.uint8)
        image[self.cell[points]] = 0
        if image.all():
            return np.full(len(image), np.inf)
        return np.asarray(cv2.distanceTransform(image.reshape(self.shape), cv2.DIST_L2, 3), np.float64).ravel()


@dataclass(eq=False)
class Sheet:
    """A plane with its cells while it is decided which of them are wall."""

    plane: Plane
    flat: tuple[int, int]  # u and v among the axes
    cells: Cells
    possible: Bool  # (U, V)
    kept: Bool  # (U, V)
    at: Int  # (S,) cell of each sample, -1 outside
    distance: Float  # (S,) to the nearest line, in samples; inf where a line behind is nearer
    depth: Float  # (S,)
    width: Float  # (U, V) px
    height: Float  # (U, V) px

    def covers(self, cells: Bool) -> Bool:
        """Samples (S,) in the given cells (U, V)."""
        return (self.at >= 0) & cells.ravel()[self.at]

    def count(self, samples: Bool) -> Int:
        """How many of the masked samples lie in each cell (U, V)."""
        counts: Int = np.bincount(self.at[samples & (self.at >= 0)], minlength=self.kept.size)
        return counts.reshape(self.kept.shape)


def take_samples(lines: Lines, camera: Camera, rotation: Float) -> Samples:
    """A raster of COLUMNS across the photo, and the lines on it."""
    step = camera.width / COLUMNS
    shape = (int(np.ceil(camera.height / step)), COLUMNS)
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    pixels = np.column_stack([columns.ravel() + 0.5, rows.ravel() + 0.5]) * step - 0.5
    length = np.linalg.norm(lines.segment[:, 1] - lines.segment[:, 0], axis=1)
    count = np.ceil(1.5 * length / step).astype(np.int64) + 2
    line = np.repeat(np.arange(len(lines)), count)
    share = (np.arange(len(line)) - np.repeat(np.cumsum(count) - count, count)) / np.repeat(count - 1, count)
    points = lines.segment[line, 0] + share[:, None] * (lines.segment[line, 1] - lines.segment[line, 0])
    column, below = np.floor((points.T + 0.5) / step).astype(np.int64)
    inside = (column >= 0) & (column < shape[1]) & (below >= 0) & (below < shape[0])
    line, points = line[inside], points[inside]
    rays = world_rays(points, camera.matrix, rotation)
    across = np.stack([(lines.axis + 1) % 3, (lines.axis + 2) % 3], axis=1)
    ray = np.take_along_axis(rays, across[line], axis=1)
    fixed = np.take_along_axis(lines.ends[:, 0], across, axis=1)[line]
    depth = (ray * fixed).sum(axis=1) / (ray**2).sum(axis=1)
    return Samples(
        shape, step, world_rays(pixels, camera.matrix, rotation), line, (below * shape[1] + column)[inside], rays, depth
    )


def build_sheet(
    plane: Plane,
    members: Int,
    planes: tuple[Plane, ...],
    lines: Lines,
    samples: Samples,
    camera: Camera,
    rotation: Float,
) -> Sheet | None:
    """The cells of a plane that its lines close in, and what the photo says about them; None where there is none."""
    u, v = (axis for axis in range(3) if axis != plane.axis)
    scale = camera.width / REFERENCE_WIDTH
    along_u, along_v = (members[lines.axis[members] == axis] for axis in (u, v))
    if not (len(along_u) and len(along_v)):
        return None
    offsets = [np.array([other.offset for other in planes if other.axis == axis]) for axis in (u, v)]
    cells = build_cells(
        _edges(lines, along_u, v, camera, rotation, scale),
        _edges(lines, along_v, u, camera, rotation, scale),
        (offsets[0], offsets[1]),
    )
    if cells is None:
        return None
    corners = np.empty((len(cells.u), len(cells.v), 3))
    corners[..., plane.axis], corners[..., u], corners[..., v] = plane.offset, cells.u[:, None], cells.v
    own = np.isin(samples.line, members)
    depth = corners @ rotation[2]
    far = depth > NEAREST * float(np.median(samples.line_depth[own])) if own.any() else np.zeros(depth.shape, bool)
    walls = np.sum(cells.walls, axis=0)
    possible = walls >= WALLS_OF_LEVEL if plane.axis == 2 else (walls >= WALLS) & (cells.walls[3] | cells.framed)
    possible = possible & far[:-1, :-1] & far[1:, :-1] & far[:-1, 1:] & far[1:, 1:]
    if not possible.any():
        return None
    pixels = project(np.where(far[..., None], corners, rotation[2]), camera.matrix, rotation)
    with np.errstate(divide="ignore", invalid="ignore"):
        sample_depth = plane.offset / samples.rays[:, plane.axis]
        plane_depth = plane.offset / samples.line_rays[:, plane.axis]
    seen = np.isfinite(sample_depth) & (sample_depth > 0)
    points = samples.rays[:, [u, v]] * np.where(seen, sample_depth, 0)[:, None]
    # Other components have scales of their own: what is behind what is not known there.
    comparable = lines.component[samples.line] == lines.component[members[0]]
    behind = comparable & ~own & (plane_depth > 0) & (samples.line_depth > (1 + BEHIND) * plane_depth)
    # Only a line that would be seen through the wall speaks against it, not one beside it.
    through = cells.find(samples.line_rays[behind][:, [u, v]] * plane_depth[behind, None])
    behind[behind] = (through >= 0) & possible.ravel()[through]
    distance, speaks = samples.distance(own), samples.distance(behind)
    return Sheet(
        plane=plane,
        flat=(u, v),
        cells=cells,
        possible=possible,
        kept=possible,
        at=np.where(seen, cells.find(points), -1),
        distance=np.where(
            distance <= np.where(speaks <= SPEAKS, speaks, np.inf) + 0.5,
            distance * (WEAK_FACTOR if lines.component[members[0]] else 1.0),
            np.inf,
        ),
        depth=np.where(seen, sample_depth, np.inf),
        width=np.linalg.norm(np.diff(pixels, axis=0), axis=2)[:, :-1],
        height=np.linalg.norm(np.diff(pixels, axis=1), axis=2)[:-1],
    )


def _edges(lines: Lines, own: Int, across: int, camera: Camera, rotation: Float, scale: float) -> Edges:
    """Lines of one direction in a plane, with how far the photo can tell coordinates apart."""
    along = int(lines.axis[own[0]])
    matrix = camera.matrix @ rotation
    order = lines.ends[own][:, :, along].argsort(axis=1)[:, :, None]
    ends = np.take_along_axis(lines.ends[own], order, axis=1)
    upper = np.take_along_axis(lines.segment[own], order, axis=1)[:, 1]
    margin = np.minimum(upper, [camera.width - 1, camera.height - 1] - upper).min(axis=1)
    image = ends @ matrix.T
    depth = np.maximum(image[..., 2:], np.finfo(float).tiny)
    pixels = image[..., :2] / depth
    # px by which a point moves in the image for each unit along an axis
    speed = {
        axis: np.linalg.norm(matrix[:2, axis] - pixels * matrix[2, axis], axis=2) / depth[..., 0]
        for axis in (along, across)
    }
    tiny = np.finfo(float).tiny
    return Edges(
        at=ends[:, 0, across],
        ends=ends[:, :, along],
        reach=SAME * scale / np.maximum(speed[across].max(axis=1), tiny),
        end_reach=ENDS_REACH * scale / np.maximum(speed[along], tiny),
        goes_on=margin <= BORDER * scale,
    )
