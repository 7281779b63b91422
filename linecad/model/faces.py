"""Faces: polygons with openings on each plane, as large as the lines say and no larger.

A cell between the lines of a plane may be wall where lines close it in; a wall ends at its top line, so that no face
reaches into the sky. Where the cells of several planes cover a pixel, it belongs to the plane with the nearest line,
and to none whose nearest line is further than a line that is seen behind it: a face hides nothing that is seen. A
window set back behind a facade takes its pixels from it, and becomes a hole with a face of its own behind. What two
faces still share in the photo stays with the one that has more of these pixels.
"""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.geometry import REFERENCE_WIDTH, project, world_rays
from linecad.model.outlines import outlines, without_slivers
from linecad.model.plane_cells import Samples, Sheet, build_sheet, take_samples
from linecad.scene import Camera, Face, Lines, Plane

LEAST_WIDTH = 30.0  # px at the reference width; narrower strips and gaps are left out of outlines
LEAST_AREA = 900.0  # px^2 at the reference width
LEAST_OVERLAP = 0.05  # px^2; what rounding makes two faces share
FIRST_SHARE, SHARE = 0.25, 0.5  # of the pixels of a cell that its plane must win: at first, then
FREE_SHARE = 0.7  # of the pixels of a cell that no other plane has; then it comes back
ROUNDS = 4
PRECISION = 1e-5  # px; to which cut outlines are rounded, so that no spike of rounding is left
LEAST_CORNERS = 3
GRAZING = 1e-6  # relative; computed corners so near to a line's coordinate are on it


def find_faces(planes: tuple[Plane, ...], lines: Lines, camera: Camera, rotation: Float) -> tuple[Plane, ...]:
    """The planes with their faces, which do not overlap in the photo. `rotation` (3, 3) takes world to camera."""
    scale = camera.width / REFERENCE_WIDTH
    samples = take_samples(lines, camera, rotation)
    row = {number: index for index, number in enumerate(lines.id.tolist())}
    sheets = []
    for plane in planes:
        members = np.array([row[number] for number in plane.lines], np.int64)
        sheet = build_sheet(plane, members, planes, lines, samples, camera, rotation)
        if sheet is not None:
            sheets.append(sheet)
    winner = _compete(sheets, len(samples.rays))
    winner = _take_back(sheets, winner)
    for number, sheet in enumerate(sheets):
        others = sheet.count(((winner >= 0) & (winner != number)) | ~np.isfinite(sheet.distance))
        free = sheet.possible & (others <= (1 - FREE_SHARE) * sheet.count(np.ones(len(winner), bool)))
        sheet.kept = without_slivers(sheet.kept, free, sheet.width, sheet.height, LEAST_WIDTH * scale)
    winner = _winner(sheets, len(samples.rays))
    found = _apart(sheets, winner, samples, camera, rotation, scale)
    return tuple(replace(plane, faces=tuple(found.get(plane.id, ()))) for plane in planes)


def _winner(sheets: list[Sheet], count: int) -> Int:
    """The sheet (S,) that each sample belongs to, -1 for none: the nearest line's, of equally near ones the nearer."""
    best, depth = np.full(count, np.inf), np.full(count, np.inf)
    winner = np.full(count, -1)
    for number, sheet in enumerate(sheets):
        covered = sheet.covers(sheet.kept) & np.isfinite(sheet.distance)
        nearer = (sheet.distance < best - 1) | ((sheet.distance < best + 1) & (sheet.depth < depth))
        better = covered & nearer
        best[better], depth[better], winner[better] = sheet.distance[better], sheet.depth[better], number
    return winner


def _compete(sheets: list[Sheet], count: int) -> Int:
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


def _take_back(sheets: list[Sheet], winner: Int) -> Int:
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
    sheets: list[Sheet], winner: Int, samples: Samples, camera: Camera, rotation: Float, scale: float
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


def _pieces(number: int, sheet: Sheet, camera: Camera, rotation: Float) -> list[_Piece]:
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


def _in_space(sheet: Sheet, flat: Float) -> Float:
    """World points (M, 3) of points (M, 2) of a plane; their coordinate along the normal is its offset exactly."""
    points = np.full((len(flat), 3), sheet.plane.offset)
    points[:, list(sheet.flat)] = flat
    return points


def _face(
    number: int, shape: shapely.Polygon, piece: _Piece, sheet: Sheet, camera: Camera, rotation: Float
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
        # Two corners of the cut outline may be one corner of a cell.
        rings.append(flat[(np.abs(flat - np.roll(flat, 1, axis=0)) > GRAZING * abs(sheet.plane.offset)).any(axis=1)])
    if len(rings[0]) < LEAST_CORNERS:
        return None
    rings[1:] = [ring for ring in rings[1:] if len(ring) >= LEAST_CORNERS]
    if not shapely.Polygon(rings[0], rings[1:]).is_valid:
        return None
    return Face(number, _in_space(sheet, rings[0]), tuple(_in_space(sheet, ring) for ring in rings[1:]))
