"""Lines that the face they lie on in the photo places better than crossings did."""

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, Turns, components
from linecad.geometry import depths_beside, middles, world_rays
from linecad.line_graph import Segments
from linecad.model.on_faces.places import Samples, can_lie
from linecad.model.on_faces.seen import NO_FACE, SeenFaces
from linecad.scene import Lines

DOUBTFUL = 0.5  # probability; what is more likely right than wrong stays
ON_STREET = 0.8  # probability that road, kerb and pavement are in their places, as measured on made streets
LEAST_SHARE = 0.6  # of a line that must lie on the face
FURTHEST = 3.0  # times the depth of its middle that an end may have there; further off lies the horizon of the face
APART = 0.01  # of the depth; what is nearer to the face is relief of it


def better_faces(lines: Lines, likely: Float, seen: SeenFaces, turns: Turns) -> Int:
    """The face (N,) that places a line better: the line is doubtful and lies before or behind it; else NO_FACE.

    `likely` (F,) is how probably each face is in its place, which must be more than the line is. Feet and kerbs tell of
    road, kerb and pavement, whatever crossings say, so that lines on them need not be doubtful. The lines are in the
    world, along the directions of all frames, of which `turns` are the further ones.
    """
    better = np.full(len(lines), NO_FACE)
    if len(lines.probability) == 0 or len(likely) == 0:
        return better
    street = _street(seen)
    likely = np.where(street, np.maximum(likely, ON_STREET), likely)
    rows = np.flatnonzero(np.asarray(lines.probability) < (ON_STREET if street.any() else DOUBTFUL))
    segments = Segments(lines.segment[rows], lines.axis[rows])
    samples = Samples.of(segments.ends, seen.camera.width)
    first, second = seen.beside(samples.pixel, samples.along)
    lies, first = _places(first, second, segments.axis[samples.row], samples.pixel, seen)
    count = np.zeros((len(rows), len(likely)), np.int64)
    np.add.at(count, (samples.row[lies], first[lies]), 1)
    face = count.argmax(axis=1)
    share = count.max(axis=1) / np.bincount(samples.row, minlength=len(rows))
    depth = seen.depths(face, middles(segments.ends))
    apart = np.abs(depth / _depths(lines.ends[rows, 0], segments, seen, turns) - 1)
    furthest = np.maximum(*(seen.depths(face, segments.ends[:, end]) for end in range(2)))
    own = np.asarray(lines.probability)[rows]
    sure = (likely[face] > own) & ((own < DOUBTFUL) | street[face])
    better[rows] = np.where(
        (share >= LEAST_SHARE) & sure & (apart > APART) & (furthest <= FURTHEST * depth), face, NO_FACE
    )
    return better


def _street(seen: SeenFaces) -> Bool:
    """Which faces (F,) are a road, its kerbs or its pavement: the ground has two levels."""
    levels = {plane.id for plane in seen.plane if plane.shows_ground}
    kinds = [face.kind for face in seen.face]
    upright = [plane.axis != UP for plane in seen.plane]
    is_own = [kind == "ground" or (kind == "other" and up) for kind, up in zip(kinds, upright, strict=True)]
    return np.array(is_own, bool) & (len(levels) > 1)


def _places(first: Int, second: Int, axis: Int, pixels: Float, seen: SeenFaces) -> tuple[Bool, Int]:
    """Which places (M,) of lines along axes (M,) lie on a face, and which: one on both sides, or where two meet."""
    can = [can_lie(axis, seen.axis[face]) for face in (first, second)]
    with np.errstate(invalid="ignore"):
        apart = np.abs(seen.depths(first, pixels) / seen.depths(second, pixels) - 1)
    meet = (first != NO_FACE) & (second != NO_FACE) & (apart <= APART)
    lies = np.where(first == second, can[0], meet & (can[0] | can[1]))
    return lies, np.where(can[0], first, second)


def _depths(points: Float, segments: Segments, seen: SeenFaces, turns: Turns) -> Float:
    """Camera depth (M,) of lines through points (M, 3), where the middle of their segments (M) shows them."""
    rays = world_rays(middles(segments.ends), seen.camera.matrix, seen.axes)
    return depths_beside(rays, components(points, turns), segments.axis)
