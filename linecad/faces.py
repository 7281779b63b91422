"""Faces: polygons with openings on each plane, as large as the lines say and no larger.

A cell between the lines of a plane may be wall where lines close it in; a wall ends at its top line, so that no face
reaches into the sky. Where the cells of several planes cover a pixel, it belongs to the plane with the nearest line,
and to none whose nearest line is further than a line that is seen behind it: a face hides nothing that is seen. A
window set back behind a facade takes its pixels from it, and becomes a hole with a face of its own behind. What two
faces still share in the photo stays with the one that has more of these pixels.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np
import shapely

from linecad.geometry import REFERENCE_WIDTH, project, world_rays
from linecad.outlines import Cells, Edges, build_cells, outlines, without_slivers
from linecad.scene import Bool, Camera, Face, Float, Int, Lines, Plane

COLUMNS = 480  # of samples across the photo
SAME = 3.0  # px at the reference width; lines that are nearer are one line of an outline
ENDS_REACH = 12.0  # px at the reference width; an end so near to a line ends there
LEAST_WIDTH = 30.0  # px at the reference width; narrower strips and gaps are left out of outlines
LEAST_AREA = 900.0  # px^2 at the reference width
LEAST_OVERLAP = 0.05  # px^2; what rounding makes two faces share
BEHIND = 0.01  # relative depth by which a line is behind a plane for sure
WALLS_OF_LEVEL = 4  # sides of a cell of a horizontal plane that lines close
WALLS = 2  # the same of a vertical plane, one of them the top
FIRST_SHARE, SHARE = 0.25, 0.5  # of the pixels of a cell that its plane must win: at first, then
FREE_SHARE = 0.7  # of the pixels of a cell that no other plane has; then it comes back
ROUNDS = 4
WEAK_FACTOR = 2.0  # by which a line of a smaller component must be nearer to win a pixel: its depth is a guess
NEAREST = 0.05  # of the middle depth; cells that reach nearer to the camera, or behind it, are none
PRECISION = 1e-5  # px; to which cut outlines are rounded, so that no spike of rounding is left
GRAZING = 1e-6  # relative; computed corners so near to a line's coordinate are on it


@dataclass(frozen=True, eq=False)
class _Samples:
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
class _Sheet:
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


def find_faces(planes: tuple[Plane, ...], lines: Lines, camera: Camera, rotation: Float) -> tuple[Plane, ...]:
    """The planes with their faces, which do not overlap in the photo. `rotation` (3, 3) takes world to camera."""
    scale = camera.width / REFERENCE_WIDTH
    samples = _samples(lines, camera, rotation)
    row = {number: index for index, number in enumerate(lines.id.tolist())}
    sheets = []
    for plane in planes:
        members = np.array([row[number] for number in plane.lines], np.int64)
        sheet = _sheet(plane, members, planes, lines, samples, camera, rotation, scale)
        if sheet is not None:
            sheets.append(sheet)
    winner = _compete(sheets, len(samples.rays))
    winner = _take_back(sheets, winner)
    for number, sheet in enumerate(sheets):
        others = sheet.count((winner >= 0) & (winner != number))
        free = sheet.possible & (others <= (1 - FREE_SHARE) * sheet.count(np.ones(len(winner), bool)))
        sheet.kept = without_slivers(sheet.kept, free, sheet.width, sheet.height, LEAST_WIDTH * scale)
    winner = _winner(sheets, len(samples.rays))
    found = _apart(sheets, winner, samples, camera, rotation, scale)
    return tuple(replace(plane, faces=tuple(found.get(plane.id, ()))) for plane in planes)


def _samples(lines: Lines, camera: Camera, rotation: Float) -> _Samples:
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
    return _Samples(
        shape, step, world_rays(pixels, camera.matrix, rotation), line, (below * shape[1] + column)[inside], rays, depth
    )


def _sheet(
    plane: Plane,
    members: Int,
    planes: tuple[Plane, ...],
    lines: Lines,
    samples: _Samples,
    camera: Camera,
    rotation: Float,
    scale: float,
) -> _Sheet | None:
    """The cells of a plane that its lines close in, and what the photo says about them; None where there is none."""
    u, v = (axis for axis in range(3) if axis != plane.axis)
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
    possible = walls >= WALLS_OF_LEVEL if plane.axis == 2 else (walls >= WALLS) & cells.walls[3]
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
    distance = samples.distance(own)
    return _Sheet(
        plane=plane,
        flat=(u, v),
        cells=cells,
        possible=possible,
        kept=possible,
        at=np.where(seen, cells.find(points), -1),
        distance=np.where(
            distance <= samples.distance(behind) + 0.5,
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
    ends = np.take_along_axis(lines.ends[own], lines.ends[own][:, :, along].argsort(axis=1)[:, :, None], axis=1)
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
    )


def _winner(sheets: list[_Sheet], count: int) -> Int:
    """The sheet (S,) that each sample belongs to, -1 for none: the nearest line's, of equally near ones the nearer."""
    best, depth = np.full(count, np.inf), np.full(count, np.inf)
    winner = np.full(count, -1)
    for number, sheet in enumerate(sheets):
        covered = sheet.covers(sheet.kept) & np.isfinite(sheet.distance)
        nearer = (sheet.distance < best - 1) | ((sheet.distance < best + 1) & (sheet.depth < depth))
        better = covered & nearer
        best[better], depth[better], winner[better] = sheet.distance[better], sheet.depth[better], number
    return winner


def _compete(sheets: list[_Sheet], count: int) -> Int:
    """Leave out the cells whose pixels belong to other planes, until nothing changes."""
    for turn in range(ROUNDS):
        winner = _winner(sheets, count)
        changed = False
        for number, sheet in enumerate(sheets):
            total, won = sheet.count(np.ones(count, bool)), sheet.count(winner == number)
            kept = sheet.kept & (won >= (SHARE if turn else FIRST_SHARE) * total)
            changed |= bool((kept != sheet.kept).any())
            sheet.kept = kept
        if not changed and turn:
            break
    return _winner(sheets, count)


def _take_back(sheets: list[_Sheet], winner: Int) -> Int:
    """Cells whose winners were left out themselves, given back to the plane that has the most around."""
    shown = np.bincount(winner[winner >= 0], minlength=len(sheets))
    for number in np.argsort(-shown, kind="stable").tolist():
        sheet = sheets[number]
        total = sheet.count(np.ones(len(winner), bool))
        free = sheet.count(np.isin(winner, (-1, number)) & np.isfinite(sheet.distance))
        back = sheet.possible & ~sheet.kept & (total > 0) & (free >= FREE_SHARE * total)
        sheet.kept = sheet.kept | back
        winner = np.where(sheet.covers(back) & (winner < 0), number, winner)
    return winner


@dataclass(eq=False)
class _Piece:
    """A polygon of a sheet in the photo, with the points in space of its corners."""

    sheet: int
    shape: shapely.Polygon  # px
    pixels: Float  # (C, 2) px, its corners
    corners: Float  # (C, 2) the same in u and v


def _apart(
    sheets: list[_Sheet], winner: Int, samples: _Samples, camera: Camera, rotation: Float, scale: float
) -> dict[int, list[Face]]:
    """Faces by plane: the outlines of the kept cells, without what belongs to others in the photo."""
    pieces = [
        piece
        for number, sheet in enumerate(sheets)
        for piece in _pieces(number, sheet, camera, rotation)
        if piece.shape.area >= LEAST_AREA * scale**2
    ]
    if not pieces:
        return {}
    shapes: list[shapely.Geometry] = [piece.shape for piece in pieces]
    column, row = np.arange(samples.shape[1]), np.arange(samples.shape[0])
    tree = shapely.STRtree(shapes)
    first, second = tree.query(shapes, predicate="intersects")
    for a, b in sorted(zip(first.tolist(), second.tolist(), strict=True)):
        if a >= b:
            continue
        shared = shapely.intersection(shapes[a], shapes[b])
        if shared.area <= LEAST_OVERLAP:
            continue
        left, top, right, bottom = (np.array(shared.bounds) + 0.5) / samples.step
        x, y = np.meshgrid(column[(column > left - 1) & (column < right)], row[(row > top - 1) & (row < bottom)])
        inside = shapely.contains_xy(shared, (x + 0.5) * samples.step - 0.5, (y + 0.5) * samples.step - 0.5)
        shown = winner[(y * samples.shape[1] + x)[inside]]
        votes = [int((shown == pieces[k].sheet).sum()) for k in (a, b)]
        ray = world_rays(shapely.get_coordinates(shapely.point_on_surface(shared)), camera.matrix, rotation)[0]
        depth = [sheets[pieces[k].sheet].plane.offset / ray[sheets[pieces[k].sheet].plane.axis] for k in (a, b)]
        front = votes[0] > votes[1] or (votes[0] == votes[1] and depth[0] <= depth[1])
        kept, cut = (a, b) if front else (b, a)
        shapes[cut] = shapely.set_precision(shapely.difference(shapes[cut], shapes[kept]), PRECISION)
    faces: dict[int, list[Face]] = {}
    count = 0
    for piece, shape in zip(pieces, shapes, strict=True):
        sheet = sheets[piece.sheet]
        for part in shapely.get_parts(shape):
            if not isinstance(part, shapely.Polygon) or part.area < LEAST_AREA * scale**2:
                continue
            if part.buffer(-LEAST_WIDTH * scale / 4).is_empty:
                continue
            face = _face(count, part, piece, sheet, camera, rotation)
            if face is not None:
                faces.setdefault(sheet.plane.id, []).append(face)
                count += 1
    return faces


def _pieces(number: int, sheet: _Sheet, camera: Camera, rotation: Float) -> list[_Piece]:
    """The outlines of the kept cells of a sheet."""
    found = []
    for polygon in outlines(sheet.kept):
        rings = []
        for ring in (polygon.exterior, *polygon.interiors):
            index = shapely.get_coordinates(ring)[:-1].astype(np.int64)
            rings.append(np.column_stack([sheet.cells.u[index[:, 0]], sheet.cells.v[index[:, 1]]]))
        pixels = [project(_in_space(sheet, ring), camera.matrix, rotation) for ring in rings]
        shape = shapely.Polygon(pixels[0], pixels[1:])
        if shape.is_valid:
            found.append(_Piece(number, shape, np.concatenate(pixels), np.concatenate(rings)))
    return found


def _in_space(sheet: _Sheet, flat: Float) -> Float:
    """World points (M, 3) of points (M, 2) of a plane; their coordinate along the normal is its offset exactly."""
    points = np.full((len(flat), 3), sheet.plane.offset)
    points[:, list(sheet.flat)] = flat
    return points


def _face(
    number: int, shape: shapely.Polygon, piece: _Piece, sheet: _Sheet, camera: Camera, rotation: Float
) -> Face | None:
    """A polygon of the photo as a face: corners of cells as they are, cut ones where their rays meet the plane."""
    rings: list[Float] = []
    for ring in (shape.exterior, *shape.interiors):
        pixels = shapely.get_coordinates(ring)[:-1]
        rays = world_rays(pixels, camera.matrix, rotation)
        flat = rays[:, list(sheet.flat)] * (sheet.plane.offset / rays[:, sheet.plane.axis])[:, None]
        for column, known in enumerate((sheet.cells.u, sheet.cells.v)):
            nearest = known[np.abs(known[:, None] - flat[:, column]).argmin(axis=0)]
            on_line = np.abs(nearest - flat[:, column]) <= GRAZING * max(float(np.ptp(known)), abs(sheet.plane.offset))
            flat[on_line, column] = nearest[on_line]
        distance = np.abs(pixels[:, None] - piece.pixels[None]).max(axis=2)
        known_corner = distance.min(axis=1) <= 2 * PRECISION
        flat[known_corner] = piece.corners[distance.argmin(axis=1)[known_corner]]
        rings.append(flat)
    if not shapely.Polygon(rings[0], rings[1:]).is_valid:
        return None
    return Face(number, _in_space(sheet, rings[0]), tuple(_in_space(sheet, ring) for ring in rings[1:]))
