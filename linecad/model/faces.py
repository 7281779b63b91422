"""Faces: polygons with openings on each plane, as large as the lines say and no larger.

A cell between the lines of a plane may be wall where lines close it in; a wall ends at its top line, so that no face
reaches into the sky. Where the cells of several planes cover a pixel, it belongs to the plane with the nearest line,
and to none whose nearest line is further than a line that is seen behind it: a face hides nothing that is seen. A
window set back behind a facade takes its pixels from it, and becomes a hole with a face of its own behind. What two
faces still share in the photo stays with the one that has more of these pixels. A pixel that faces along another axis
than a plane, as a depth map tells, does not belong to it.
"""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.depth.normals import Normals
from linecad.geometry import PhotoLength, project, world_rays
from linecad.model.outlines import outlines, without_slivers
from linecad.model.plane_cells import PlaneCells, Samples, build_plane_cells, take_samples
from linecad.scene import Camera, Face, Lines, Plane

LEAST_WIDTH = PhotoLength(30.0)  # narrower strips and gaps are left out of outlines
LEAST_SIDE = PhotoLength(30.0)  # of a square as large as the smallest face
LEAST_OVERLAP = 0.05  # px^2; what rounding makes two faces share
FIRST_SHARE, SHARE = 0.25, 0.5  # of the pixels of a cell that its plane must win: at first, then
FREE_SHARE = 0.7  # of the pixels of a cell that no other plane has; then it comes back
ROUNDS = 4
PRECISION = 1e-5  # px; to which cut outlines are rounded, so that no spike of rounding is left
LEAST_CORNERS = 3
GRAZING = 1e-6  # relative; computed corners so near to a line's coordinate are on it


def find_faces(
    planes: tuple[Plane, ...], lines: Lines, camera: Camera, rotation: Float, normals: Normals | None = None
) -> tuple[Plane, ...]:
    """The planes with their faces, which do not overlap in the photo. `rotation` (3, 3) takes world to camera.

    `normals` are those of a depth map on the photo's pixels, where there is one that has them.
    """
    samples = take_samples(lines, camera, rotation, normals)
    row = {number: index for index, number in enumerate(lines.id.tolist())}
    cell_sets = []
    for plane in planes:
        members = np.array([row[number] for number in plane.lines], np.int64)
        cells = build_plane_cells(plane, members, planes, lines, samples, camera, rotation)
        if cells is not None:
            cell_sets.append(cells)
    winner = _take_back(cell_sets, _compete(cell_sets, len(samples.rays)))
    for number, cells in enumerate(cell_sets):
        shown = winner[cells.sample]
        others = cells.count(((shown >= 0) & (shown != number)) | ~np.isfinite(cells.distance))
        free = cells.possible & (others <= (1 - FREE_SHARE) * cells.total)
        cells.kept = without_slivers(cells.kept, free, cells.width, cells.height, LEAST_WIDTH.px(camera.width))
    winner = _winner(cell_sets, len(samples.rays))
    found = _apart(cell_sets, winner, samples, camera, rotation)
    return tuple(replace(plane, faces=tuple(found.get(plane.id, ()))) for plane in planes)


def _winner(cell_sets: list[PlaneCells], count: int) -> Int:
    """The plane (S,) that each sample belongs to, -1 for none: the nearest line's, of equally near ones the nearer."""
    best, depth = np.full(count, np.inf), np.full(count, np.inf)
    winner = np.full(count, -1)
    for number, cells in enumerate(cell_sets):
        covered = cells.covers(cells.kept) & np.isfinite(cells.distance)
        before, behind = best[cells.sample], depth[cells.sample]
        nearer = (cells.distance < before - 1) | ((cells.distance < before + 1) & (cells.depth < behind))
        better = covered & nearer
        own = cells.sample[better]
        best[own], depth[own], winner[own] = cells.distance[better], cells.depth[better], number
    return winner


def _compete(cell_sets: list[PlaneCells], count: int) -> Int:
    """Leave out the cells whose pixels belong to other planes, until nothing changes."""
    for turn in range(ROUNDS):
        winner = _winner(cell_sets, count)
        changed = False
        for number, cells in enumerate(cell_sets):
            won = cells.count(winner[cells.sample] == number)
            kept = cells.kept & (won >= (SHARE if turn else FIRST_SHARE) * cells.total)
            changed |= bool((kept != cells.kept).any())
            cells.kept = kept
        if not changed and turn:
            break
    return _winner(cell_sets, count)


def _take_back(cell_sets: list[PlaneCells], winner: Int) -> Int:
    """Cells whose winners were left out themselves, given back to the plane that has the most around."""
    winner = winner.copy()
    shown = np.bincount(winner[winner >= 0], minlength=len(cell_sets))
    for number in np.argsort(-shown, kind="stable").tolist():
        cells = cell_sets[number]
        seen = winner[cells.sample]
        free = cells.count(((seen < 0) | (seen == number)) & np.isfinite(cells.distance))
        back = cells.possible & ~cells.kept & (cells.total > 0) & (free >= FREE_SHARE * cells.total)
        cells.kept = cells.kept | back
        winner[cells.sample[cells.covers(back) & (seen < 0)]] = number
    return winner


@dataclass(eq=False)
class _Piece:
    """A polygon of kept cells in the photo, with the points in space of its corners."""

    owner: int  # the place of its plane among those with cells
    shape: shapely.Polygon  # px
    pixels: Float  # (C, 2) px, its corners
    corners: Float  # (C, 2) the same in u and v


def _apart(
    cell_sets: list[PlaneCells], winner: Int, samples: Samples, camera: Camera, rotation: Float
) -> dict[int, list[Face]]:
    """Faces by plane: the outlines of the kept cells, without what belongs to others in the photo."""
    least_area = LEAST_SIDE.px(camera.width) ** 2
    pieces = [
        piece
        for number, cells in enumerate(cell_sets)
        for piece in _pieces(number, cells, camera, rotation)
        if piece.shape.area >= least_area
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
        votes = [int((shown == pieces[k].owner).sum()) for k in (a, b)]
        ray = world_rays(shapely.get_coordinates(shapely.point_on_surface(shared)), camera.matrix, rotation)[0]
        depth = [cell_sets[pieces[k].owner].plane.offset / ray[cell_sets[pieces[k].owner].plane.axis] for k in (a, b)]
        front = votes[0] > votes[1] or (votes[0] == votes[1] and depth[0] <= depth[1])
        kept, cut = (a, b) if front else (b, a)
        shapes[cut] = shapely.set_precision(shapely.difference(shapes[cut], shapes[kept]), PRECISION)
    faces: dict[int, list[Face]] = {}
    count = 0
    for piece, shape in zip(pieces, shapes, strict=True):
        cells = cell_sets[piece.owner]
        for part in shapely.get_parts(shape):
            if not isinstance(part, shapely.Polygon) or part.area < least_area:
                continue
            if part.buffer(-LEAST_WIDTH.px(camera.width) / 4).is_empty:
                continue
            face = _face(count, part, piece, cells, camera, rotation)
            if face is not None:
                faces.setdefault(cells.plane.id, []).append(face)
                count += 1
    return faces


def _pieces(number: int, cells: PlaneCells, camera: Camera, rotation: Float) -> list[_Piece]:
    """The outlines of the kept cells of a plane."""
    found = []
    for polygon in outlines(cells.kept):
        rings = []
        for ring in (polygon.exterior, *polygon.interiors):
            index = shapely.get_coordinates(ring)[:-1].astype(np.int64)
            rings.append(np.column_stack([cells.grid.u[index[:, 0]], cells.grid.v[index[:, 1]]]))
        pixels = [project(_in_space(cells, ring), camera.matrix, rotation) for ring in rings]
        shape = shapely.Polygon(pixels[0], pixels[1:])
        if shape.is_valid:
            found.append(_Piece(number, shape, np.concatenate(pixels), np.concatenate(rings)))
    return found


def _in_space(cells: PlaneCells, flat: Float) -> Float:
    """World points (M, 3) of points (M, 2) of a plane; their coordinate along the normal is its offset exactly."""
    points = np.full((len(flat), 3), cells.plane.offset)
    points[:, list(cells.flat)] = flat
    return points


def _face(
    number: int, shape: shapely.Polygon, piece: _Piece, cells: PlaneCells, camera: Camera, rotation: Float
) -> Face | None:
    """A polygon of the photo as a face: corners of cells as they are, cut ones where their rays meet the plane."""
    rings: list[Float] = []
    for ring in (shape.exterior, *shape.interiors):
        pixels = shapely.get_coordinates(ring)[:-1]
        rays = world_rays(pixels, camera.matrix, rotation)
        flat = rays[:, list(cells.flat)] * (cells.plane.offset / rays[:, cells.plane.axis])[:, None]
        for column, known in enumerate((cells.grid.u, cells.grid.v)):
            nearest = known[np.abs(known[:, None] - flat[:, column]).argmin(axis=0)]
            on_line = np.abs(nearest - flat[:, column]) <= GRAZING * max(float(np.ptp(known)), abs(cells.plane.offset))
            flat[on_line, column] = nearest[on_line]
        distance = np.abs(pixels[:, None] - piece.pixels[None]).max(axis=2)
        known_corner = distance.min(axis=1) <= 2 * PRECISION
        flat[known_corner] = piece.corners[distance.argmin(axis=1)[known_corner]]
        # Two corners of the cut outline may be one corner of a cell.
        rings.append(flat[(np.abs(flat - np.roll(flat, 1, axis=0)) > GRAZING * abs(cells.plane.offset)).any(axis=1)])
    if len(rings[0]) < LEAST_CORNERS:
        return None
    rings[1:] = [ring for ring in rings[1:] if len(ring) >= LEAST_CORNERS]
    if not shapely.Polygon(rings[0], rings[1:]).is_valid:
        return None
    return Face(number, _in_space(cells, rings[0]), tuple(_in_space(cells, ring) for ring in rings[1:]))
