"""The edges of faces as lines: feet and eaves of walls, their corners, the sides of openings.

An edge of a face is one of the building where the face is the nearer of what the photo shows on its two sides. Where
something stands before the face, the edge is that thing's, and where the photo ends, it is none.
"""

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import Turns, directions_of
from linecad.geometry import project, ring_sides
from linecad.line_graph import Segments
from linecad.model.on_faces.places import Samples, Stretches, can_lie, stretches
from linecad.model.on_faces.seen import BESIDE, NO_FACE, SeenFaces
from linecad.scene import Camera

STRAIGHT = 1e-9  # of its length, by which an edge along an axis may stray from it
BESIDE_EDGE = 0.02  # of the depth, in which a face has the edge


def edges_of(seen: SeenFaces, rotation: Float, turns: Turns) -> tuple[Segments, Int]:
    """The edges of the faces that run along an axis, as the photo shows them, and the face (E,) that each is on."""
    sides, owner = _sides(seen)
    vectors = sides[:, 1] - sides[:, 0]
    along = np.abs(vectors @ directions_of(turns).T)
    axis = along.argmax(axis=1)
    straight = along.max(axis=1) >= (1 - STRAIGHT) * np.linalg.norm(vectors, axis=1)
    sides, owner, axis = sides[straight], owner[straight], axis[straight]
    kept = can_lie(axis, seen.axis[owner])
    segments = Segments(project(sides[kept].reshape(-1, 3), seen.camera.matrix, rotation).reshape(-1, 2, 2), axis[kept])
    found = shown(segments, owner[kept], seen)
    return found.segments(segments), found.face


def _sides(seen: SeenFaces) -> tuple[Float, Int]:
    """All sides (E, 2, 3) of the rings of all faces, and whose they are (E,)."""
    parts, owner = [np.zeros((0, 2, 3))], [np.zeros(0, np.int64)]
    for number, face in enumerate(seen.face):
        parts.append(ring_sides((face.outline, *face.holes)))
        owner.append(np.full(len(parts[-1]), number))
    return np.concatenate(parts), np.concatenate(owner)


def shown(segments: Segments, owner: Int, seen: SeenFaces) -> Stretches:
    """The stretches of edges (E) of faces `owner` (E,) where the photo shows nothing before these."""
    samples = Samples.of(segments.ends, seen.camera.width)
    face = owner[samples.row]
    sides = seen.beside(samples.pixel, samples.along)
    nearest = np.minimum(*(seen.depths(side, samples.pixel) for side in sides))
    own = seen.depths(face, samples.pixel)
    shows = np.where(_inside(samples.pixel, seen.camera) & (np.abs(nearest / own - 1) <= BESIDE_EDGE), face, NO_FACE)
    return stretches(samples, shows, segments, seen.camera.width)


def _inside(pixels: Float, camera: Camera) -> Bool:
    """Which pixels (M, 2) lie so far inside the photo that both sides of a line there are seen."""
    margin = BESIDE.px(camera.width)
    last = np.array([camera.width - 1, camera.height - 1]) - margin
    return np.asarray(((pixels > margin) & (pixels < last)).all(axis=1))
