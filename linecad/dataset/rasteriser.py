"""What each pixel of a photo shows and which pieces of edges are visible, exactly, in double precision.

A depth buffer: every quad is clipped at the near plane, and at the centres of the pixels that it covers the inverse
depth of its plane, which is linear in the image, is compared. An edge is visible where one of the four pixels around
a point of it shows a quad in whose plane the point lies.
"""

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.dataset.truth import NOTHING, planes_of

NEAR = 0.05  # m, camera depth of the near plane
SAMPLE = 1.0  # px between the points of an edge that are tested
IN_PLANE = 1e-6  # m, between a point of an edge and a plane that it lies in
GAP = 3.0  # px; a shorter interruption of an edge, as by a thing thinner than a pixel, does not part it
SHORTEST = 2.0  # px; shorter pieces are not told
ROUNDING = 1e-6  # px, far more than the place of a corner may be off
CHUNK = 400_000  # points tested at a time, which bounds the memory


def rasterise(quads: Float, matrix: Float, rotation: Float, width: int, height: int) -> tuple[Int, Float]:
    """The quad (H, W) that the centre of each pixel shows, or NOTHING, and its inverse camera depth (H, W), 1/m.

    `quads` (Q, 4, 3) are corners in the world, m; of two at the same depth the first one is shown.
    """
    camera = quads @ rotation.T
    inverse_depth = np.zeros((height, width))
    ids = np.full((height, width), NOTHING, np.int64)
    from_pixel = np.linalg.inv(matrix)
    normals = np.cross(camera[:, 1] - camera[:, 0], camera[:, 3] - camera[:, 0])
    for index in _in_view(camera, matrix, width, height):
        normal = normals[index]
        offset = normal @ camera[index, 0]
        if abs(offset) <= 1e-12 * np.abs(normal).sum():
            continue  # seen edge on
        outline = clip_near(camera[index])
        if len(outline) < 3:
            continue
        image = outline @ matrix.T
        image = image[:, :2] / image[:, 2:]
        _draw(image, normal @ from_pixel / offset, int(index), inverse_depth, ids)
    return ids, inverse_depth


def _in_view(camera: Float, matrix: Float, width: int, height: int) -> Int:
    """The quads that may cover the centre of a pixel.

    Not those whose corners all lie beyond one side of what the camera sees, nor those that fit between two rows or
    columns of centres: most of a street in a small photo.
    """
    image = camera @ matrix.T
    x, y, z = image[..., 0], image[..., 1], image[..., 2]
    outside = (z < NEAR).all(axis=1)
    for beyond in (x < 0, x > (width - 1) * z, y < 0, y > (height - 1) * z):
        outside |= (beyond & (z > 0)).all(axis=1)
    before: Bool = np.asarray((z >= NEAR).all(axis=1))
    for along in (x, y):
        place = along / np.where(before[:, None], z, 1.0)
        outside |= before & (np.ceil(place.min(axis=1) - ROUNDING) > np.floor(place.max(axis=1) + ROUNDING))
    inside: Int = np.flatnonzero(~outside)
    return inside


def clip_near(outline: Float, near: float = NEAR) -> Float:
    """The part of a convex polygon (N, 3) of the camera frame before the plane of depth `near`."""
    before = outline[:, 2] >= near
    if before.all():
        return outline
    kept = []
    for index, point in enumerate(outline):
        other = outline[index - 1]
        if before[index] != before[index - 1]:
            kept.append(other + (near - other[2]) / (point[2] - other[2]) * (point - other))
        if before[index]:
            kept.append(point)
    return np.array(kept).reshape(-1, 3)


def _draw(image: Float, plane: Float, index: int, inverse_depth: Float, ids: Int) -> None:
    """Draw a convex polygon (N, 2) px; `plane` @ (x, y, 1) is its inverse depth."""
    height, width = ids.shape
    low = np.maximum(np.ceil(image.min(axis=0)), 0).astype(int)
    high = np.minimum(np.floor(image.max(axis=0)), (width - 1, height - 1)).astype(int)
    if (low > high).any():
        return
    x = np.arange(low[0], high[0] + 1, dtype=np.float64)
    y = np.arange(low[1], high[1] + 1, dtype=np.float64)[:, None]
    following = np.concatenate([image[1:], image[:1]])
    turn = np.sign((image[:, 0] * following[:, 1] - following[:, 0] * image[:, 1]).sum())
    inside: Bool = np.ones((len(y), len(x)), bool)
    for (from_x, from_y), (side_x, side_y) in zip(image.tolist(), (turn * (following - image)).tolist(), strict=True):
        inside &= side_x * (y - from_y) >= side_y * (x - from_x)
    window = np.s_[low[1] : high[1] + 1, low[0] : high[0] + 1]
    depth = plane[0] * x + (plane[1] * y + plane[2])
    inside &= depth > inverse_depth[window]
    inverse_depth[window][inside] = depth[inside]
    ids[window][inside] = index


def visible_pieces(
    edges: Float, quads: Float, matrix: Float, rotation: Float, ids: Int, in_plane: float = IN_PLANE
) -> tuple[Float, Int]:
    """Ends (V, 2, 2), px, of the visible pieces of edges (M, 2, 3), and the edge (V,) that each shows.

    `in_plane`, m, is how far off a plane a point of an edge may lie that is in it, at a depth near 0; more farther off.

    Pieces lie inside the photo and end within about a pixel of where the edge does, or where something hides it.
    """
    height, width = ids.shape
    camera = edges @ rotation.T
    image, depth, keep = project_edges(camera, matrix, width, height)
    length = np.linalg.norm(image[:, 1] - image[:, 0], axis=1)
    counts = np.maximum(np.ceil(length / SAMPLE).astype(np.int64), 1) + 1
    planes = _plane_table(quads)
    pieces: list[Float] = []
    owners: list[int] = []
    start = 0
    while start < len(keep):
        stop = start + max(1, int(np.searchsorted(np.cumsum(counts[start:]), CHUNK, "right")))
        owner = np.repeat(np.arange(start, stop), counts[start:stop])
        first = np.concatenate([[0], np.cumsum(counts[start:stop])[:-1]])
        place = np.arange(len(owner)) - np.repeat(first, counts[start:stop])
        share = place / (counts[owner] - 1)
        pixels = image[owner, 0] + share[:, None] * (image[owner, 1] - image[owner, 0])
        inverse = (1 - share) / depth[owner, 0] + share / depth[owner, 1]
        seen = _is_seen(pixels, 1 / inverse, ids, planes, matrix @ rotation, in_plane)
        for row in range(start, stop):
            begin = int(first[row - start])
            runs = _runs(seen[begin : begin + int(counts[row])], length[row] / (counts[row] - 1))
            for low, high in runs:
                pieces.append(pixels[[begin + low, begin + high]])
                owners.append(int(keep[row]))
        start = stop
    return np.array(pieces).reshape(-1, 2, 2), np.array(owners, np.int64)


def project_edges(
    camera: Float, matrix: Float, width: int, height: int, near: float = NEAR
) -> tuple[Float, Float, Int]:
    """Ends (K, 2, 2), px, and depths (K, 2) of the edges inside the photo, and which of them (K,) these are.

    The edges (M, 2, 3) are in the camera frame; `near` is the depth of the near plane, in their unit.
    """
    ends = camera.copy()
    keep = (ends[..., 2] > near).any(axis=1)
    for this, other in ((0, 1), (1, 0)):
        behind = keep & (ends[:, this, 2] < near)
        share = (near - ends[behind, this, 2]) / (ends[behind, other, 2] - ends[behind, this, 2])
        ends[behind, this] += share[:, None] * (ends[behind, other] - ends[behind, this])
    ends[~keep] = (0.0, 0.0, 1.0)
    image = ends @ matrix.T
    image = image[..., :2] / image[..., 2:]
    # Liang and Barsky's clipping, all edges at once.
    step = image[:, 1] - image[:, 0]
    low, high = np.zeros(len(ends)), np.ones(len(ends))
    for axis, limit in ((0, width - 1), (1, height - 1)):
        for slope, room in ((-step[:, axis], image[:, 0, axis]), (step[:, axis], limit - image[:, 0, axis])):
            with np.errstate(divide="ignore", invalid="ignore"):
                ratio = room / slope
            low = np.where(slope < 0, np.maximum(low, ratio), low)
            high = np.where(slope > 0, np.minimum(high, ratio), high)
            keep &= (slope != 0) | (room >= 0)
    keep &= low < high
    low, high, image, inverse = low[keep], high[keep], image[keep], 1 / ends[keep][..., 2]
    shares = np.stack([low, high], axis=1)
    clipped = image[:, :1] + shares[..., None] * (image[:, 1:] - image[:, :1])
    depth = 1 / (inverse[:, :1] + shares * (inverse[:, 1:] - inverse[:, :1]))
    return clipped, depth, np.flatnonzero(keep)


def _plane_table(quads: Float) -> Float:
    """Normals and offsets (Q + 1, 4) of the quads; the last row, for the sky, is no plane."""
    normal, offset = planes_of(quads)
    return np.vstack([np.column_stack([normal, offset]), [np.nan] * 4])


def _is_seen(pixels: Float, depth: Float, ids: Int, planes: Float, projection: Float, in_plane: float) -> Bool:
    """Whether points (N,) of edges lie in the plane of a quad that a pixel beside them shows."""
    height, width = ids.shape
    rays = np.column_stack([pixels, np.ones(len(pixels))]) @ np.linalg.inv(projection).T
    points = rays * depth[:, None]
    corner = np.floor(pixels).astype(np.int64)
    seen = np.zeros(len(pixels), bool)
    for right in (0, 1):
        for down in (0, 1):
            column = np.clip(corner[:, 0] + right, 0, width - 1)
            row = np.clip(corner[:, 1] + down, 0, height - 1)
            plane = planes[ids[row, column]]
            seen |= np.abs((plane[:, :3] * points).sum(axis=1) - plane[:, 3]) < in_plane * (1 + depth)
    return seen


def _runs(seen: Bool, step: float) -> list[tuple[int, int]]:
    """First and last index of each run of seen points, `step` px apart; short gaps closed, short runs left out."""
    where = np.flatnonzero(seen)
    if len(where) == 0:
        return []
    breaks = np.flatnonzero(np.diff(where) * step > GAP)
    starts = where[np.concatenate([[0], breaks + 1])]
    ends = where[np.concatenate([breaks, [len(where) - 1]])]
    long_enough = (ends - starts) * step >= SHORTEST
    return list(zip(starts[long_enough].tolist(), ends[long_enough].tolist(), strict=True))
