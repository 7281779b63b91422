"""What lines and photo say about each plane: its cells, which of them may be wall, and how near its lines are.

A cell may be wall where lines close it in. A wall ends at its top line, so that no face reaches into the sky; where
lines on both sides go on above the photo, so does the wall between them.
"""

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.depth.normals import UNTOLD, Normals
from linecad.geometry import PhotoLength, project, world_rays
from linecad.model.outlines import Cells, Edges, build_cells
from linecad.scene import Camera, Lines, Plane

COLUMNS = 480  # of samples across the photo
SAME = PhotoLength(3.0)  # lines that are nearer are one line of an outline
ENDS_REACH = PhotoLength(12.0)  # an end so near to a line ends there
BORDER = PhotoLength(30.0)  # a line that ends so near to the photo's border goes on outside
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
    facing: Int  # (S,) axis along which what it shows faces by a depth map, or UNTOLD

    def distance(self, sample: Int, points: Bool) -> Float:
        """Distance (M,) in samples from some of them to the nearest of the masked points on lines."""
        image = np.ones(self.shape[0] * self.shape[1], np.uint8)
        image[self.cell[points]] = 0
        if image.all():
            return np.full(len(sample), np.inf)
        distance = cv2.distanceTransform(image.reshape(self.shape), cv2.DIST_L2, 3)
        return np.asarray(distance.ravel()[sample], np.float64)


@dataclass(eq=False)
class PlaneCells:
    """The cells of one plane while it is decided which of them are wall.

    Of the samples of the photo only the M count that show a possible cell.
    """

    plane: Plane
    flat: tuple[int, int]  # u and v among the axes
    grid: Cells
    possible: Bool  # (U, V)
    kept: Bool  # (U, V)
    sample: Int  # (M,) ascending
    at: Int  # (M,) flat index of its cell
    distance: Float  # (M,) to the nearest line, in samples; inf where a line behind is nearer, or it faces elsewhere
    depth: Float  # (M,)
    width: Float  # (U, V) px
    height: Float  # (U, V) px

    def covers(self, cells: Bool) -> Bool:
        """Mask (M,) of the samples in the given cells (U, V)."""
        covered: Bool = cells.ravel()[self.at]
        return covered

    def count(self, samples: Bool) -> Int:
        """How many of the masked samples (M,) lie in each cell (U, V)."""
        counts: Int = np.bincount(self.at[samples], minlength=self.kept.size)
        return counts.reshape(self.kept.shape)

    @cached_property
    def total(self) -> Int:
        """How many samples lie in each cell (U, V); 0 where it is not possible."""
        return self.count(np.ones(len(self.at), bool))


def take_samples(lines: Lines, camera: Camera, rotation: Float, normals: Normals | None) -> Samples:
    """A raster of COLUMNS across the photo, and the lines and what a map of its pixels tells on it."""
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
    rays = np.asfortranarray(world_rays(points, camera.matrix, rotation))
    across = np.stack([(lines.axis + 1) % 3, (lines.axis + 2) % 3], axis=1)
    ray = np.take_along_axis(rays, across[line], axis=1)
    fixed = np.take_along_axis(lines.ends[:, 0], across, axis=1)[line]
    depth = (ray * fixed).sum(axis=1) / (ray**2).sum(axis=1)
    # By columns, as planes look at one coordinate of all.
    all_rays = np.asfortranarray(world_rays(pixels, camera.matrix, rotation))
    facing = np.full(len(pixels), UNTOLD)
    if normals is not None:
        at_x, at_y = np.minimum(np.rint(pixels).astype(np.int64), [camera.width - 1, camera.height - 1]).T
        facing = normals.axes_at(at_y, at_x, rotation)
    return Samples(shape, step, all_rays, line, (below * shape[1] + column)[inside], rays, depth, facing)


def build_plane_cells(
    plane: Plane,
    members: Int,
    planes: tuple[Plane, ...],
    lines: Lines,
    samples: Samples,
    camera: Camera,
    rotation: Float,
) -> PlaneCells | None:
    """The cells of a plane that its lines close in, and what the photo says about them; None where there is none."""
    u, v = (axis for axis in range(3) if axis != plane.axis)
    along_u, along_v = (members[lines.axis[members] == axis] for axis in (u, v))
    if not (len(along_u) and len(along_v)):
        return None
    offsets = [np.array([other.offset for other in planes if other.axis == axis]) for axis in (u, v)]
    edges_u, edges_v = _edges(lines, along_u, v, camera, rotation), _edges(lines, along_v, u, camera, rotation)
    grid = build_cells(edges_u, edges_v, (offsets[0], offsets[1]))
    if grid is None:
        return None
    corners = np.empty((len(grid.u), len(grid.v), 3))
    corners[..., plane.axis], corners[..., u], corners[..., v] = plane.offset, grid.u[:, None], grid.v
    is_member = np.zeros(len(lines), bool)
    is_member[members] = True
    own = is_member[samples.line]
    depth = corners @ rotation[2]
    far = depth > NEAREST * float(np.median(samples.line_depth[own])) if own.any() else np.zeros(depth.shape, bool)
    possible = _possible(plane, grid, far)
    if not possible.any():
        return None
    pixels = project(np.where(far[..., None], corners, rotation[2]), camera.matrix, rotation)
    component = lines.component[members[0]]
    # Other components have scales of their own: what is behind what is not known there.
    comparable = lines.component[samples.line] == component
    sample, at, sample_depth = _samples_of(plane, (u, v), grid, possible, samples)
    behind = _behind(plane, (u, v), grid, possible, samples, comparable & ~own)
    distance, speaks = samples.distance(sample, own), samples.distance(sample, behind)
    nearest = distance <= np.where(speaks <= SPEAKS, speaks, np.inf) + 0.5
    facing = samples.facing[sample]
    nearest &= (facing == plane.axis) | (facing == UNTOLD)
    return PlaneCells(
        plane=plane,
        flat=(u, v),
        grid=grid,
        possible=possible,
        kept=possible,
        sample=sample,
        at=at,
        distance=np.where(nearest, distance, np.inf) * (WEAK_FACTOR if component else 1.0),
        depth=sample_depth,
        width=np.linalg.norm(np.diff(pixels, axis=0), axis=2)[:, :-1],
        height=np.linalg.norm(np.diff(pixels, axis=1), axis=2)[:-1],
    )


def _possible(plane: Plane, grid: Cells, far: Bool) -> Bool:
    """Which cells (U, V) may be wall: those that lines close in and whose corners are `far` enough (U + 1, V + 1)."""
    walls = np.sum(grid.walls, axis=0)
    possible = walls >= WALLS_OF_LEVEL if plane.axis == 2 else (walls >= WALLS) & (grid.walls[3] | grid.framed)
    whole: Bool = possible & far[:-1, :-1] & far[1:, :-1] & far[:-1, 1:] & far[1:, 1:]
    return whole


def _samples_of(
    plane: Plane, flat: tuple[int, int], grid: Cells, possible: Bool, samples: Samples
) -> tuple[Int, Int, Float]:
    """The samples (M,) that show a possible cell of a plane, their cells and their depths."""
    with np.errstate(divide="ignore"):
        depth = plane.offset / samples.rays[:, plane.axis]
    sample = np.flatnonzero(np.isfinite(depth) & (depth > 0))
    for axis, coordinates in zip(flat, (grid.u, grid.v), strict=True):  # few are inside, and only those are looked up
        place = samples.rays[sample, axis] * depth[sample]
        sample = sample[(place > coordinates[0]) & (place <= coordinates[-1])]
    at = grid.find(samples.rays[sample][:, flat] * depth[sample, None])
    shows = possible.ravel()[at]
    return sample[shows], at[shows], depth[sample[shows]]


def _behind(
    plane: Plane, flat: tuple[int, int], grid: Cells, possible: Bool, samples: Samples, comparable: Bool
) -> Bool:
    """Which points on lines (T,) are behind possible wall of a plane, of those whose depth is comparable."""
    with np.errstate(divide="ignore", invalid="ignore"):
        plane_depth = plane.offset / samples.line_rays[:, plane.axis]
    behind = comparable & (plane_depth > 0) & (samples.line_depth > (1 + BEHIND) * plane_depth)
    # Only a line that would be seen through the wall speaks against it, not one beside it.
    through = grid.find(samples.line_rays[behind][:, flat] * plane_depth[behind, None])
    behind[behind] = (through >= 0) & possible.ravel()[through]
    return behind


def _edges(lines: Lines, own: Int, across: int, camera: Camera, rotation: Float) -> Edges:
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
        reach=SAME.px(camera.width) / np.maximum(speed[across].max(axis=1), tiny),
        end_reach=ENDS_REACH.px(camera.width) / np.maximum(speed[along], tiny),
        goes_on=margin <= BORDER.px(camera.width),
    )
