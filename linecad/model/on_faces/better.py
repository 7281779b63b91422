"""Lines that the face they lie on in the photo places better than crossings did."""

import numpy as np

from linecad.arrays import Bool, Float
from linecad.directions import Turns, components
from linecad.geometry import depths_beside, middles, world_rays
from linecad.line_graph import Segments
from linecad.model.on_faces.places import Samples, can_lie
from linecad.model.on_faces.seen import SeenFaces
from linecad.scene import Lines

DOUBTFUL = 0.5  # probability; what is more likely right than wrong stays
LEAST_SHARE = 0.6  # of a line that must lie on the face
APART = 0.01  # of the depth; what is nearer to the face is relief of it


def better_placed(lines: Lines, likely: Float, seen: SeenFaces, turns: Turns) -> Bool:
    """Which lines (N,) are doubtful and lie, before or behind it, on a face that is more `likely` (F,) in its place.

    The lines are in the world, along the directions of all frames, of which `turns` are the further ones.
    """
    better = np.zeros(len(lines), bool)
    if len(lines.probability) == 0 or len(likely) == 0:
        return better
    rows = np.flatnonzero(np.asarray(lines.probability) < DOUBTFUL)
    segments = Segments(lines.segment[rows], lines.axis[rows])
    samples = Samples.of(segments.ends, seen.camera.width)
    first, second = seen.beside(samples.pixel, samples.along)
    lies = (first == second) & can_lie(segments.axis[samples.row], seen.axis[first])
    count = np.zeros((len(rows), len(likely)), np.int64)
    np.add.at(count, (samples.row[lies], first[lies]), 1)
    face = count.argmax(axis=1)
    share = count.max(axis=1) / np.bincount(samples.row, minlength=len(rows))
    apart = np.abs(seen.depths(face, middles(segments.ends)) / _depths(lines.ends[rows, 0], segments, seen, turns) - 1)
    sure = likely[face] > np.asarray(lines.probability)[rows]
    better[rows] = (share >= LEAST_SHARE) & sure & (apart > APART)
    return better


def _depths(points: Float, segments: Segments, seen: SeenFaces, turns: Turns) -> Float:
    """Camera depth (M,) of lines through points (M, 3), where the middle of their segments (M) shows them."""
    rays = world_rays(middles(segments.ends), seen.camera.matrix, seen.axes)
    return depths_beside(rays, components(points, turns), segments.axis)
