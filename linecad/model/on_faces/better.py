"""Lines that the face they lie on in the photo places better than crossings did.

What is seen on a face cannot lie behind it: one of the two is in a wrong place. Where the face is ground, it is always
the line; where it is a wall, the wall may be one that is not there.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, Turns, components
from linecad.geometry import depths_beside, middles, world_rays
from linecad.line_graph import Segments
from linecad.model.on_faces.places import Samples, can_lie
from linecad.model.on_faces.seen import NO_FACE, SeenFaces
from linecad.scene import Lines

DOUBTFUL = 0.5  # probability; what is more likely right than wrong stays, unless it is below the ground
ON_STREET = 0.8  # probability that road, kerb and pavement are in their places, as measured on made streets
LEAST_SHARE = 0.6  # of a line that must lie on the face
FURTHEST = 3.0  # times the depth of its middle that an end may have there; further off lies the horizon of the face
STRETCHED = 1.1  # times as far as it is now, by the same measure, may an end be in any case
APART = 0.01  # of the depth; what is nearer to the face is relief of it
BEHIND = 1.05  # times the depth of the face, from which on it is no recess
LEAST_LIKELY = 0.4  # probability of a face that hides what is behind it, ground without lines included


@dataclass(frozen=True, eq=False)
class BetterPlaces:
    """What faces say of the places of N lines."""

    face: Int  # (N,) that places a line better, NO_FACE for none
    nowhere: Bool  # (N,) doubtful and behind what they are seen on, or on a thing before it, and no face places them

    @classmethod
    def none(cls, count: int) -> "BetterPlaces":
        """Faces say nothing of any line."""
        return cls(np.full(count, NO_FACE), np.zeros(count, bool))


def better_places(lines: Lines, likely: Float, seen: SeenFaces, turns: Turns) -> BetterPlaces:
    """Where faces place lines better: doubtful ones before or behind their face, and all that are below the ground.

    `likely` (F,) is how probably each face is in its place, which must be more than the line is, but where the line is
    behind the face. Feet and kerbs tell of road, kerb and pavement, whatever crossings say, so that lines on them need
    not be doubtful. The lines are in the world, along the directions of all frames, of which `turns` are the further
    ones.
    """
    if len(lines.probability) == 0 or len(likely) == 0:
        return BetterPlaces.none(len(lines))
    street = _street(seen)
    likely = np.where(street, np.maximum(likely, ON_STREET), likely)
    segments, own = Segments(lines.segment, lines.axis), np.asarray(lines.probability)
    samples = Samples.of(segments.ends, seen.camera.width)
    before = _before(samples, lines, seen, turns)
    face, share = before.most_of(len(lines), samples.row)
    at = np.stack([segments.ends[:, 0], middles(segments.ends), segments.ends[:, 1]])
    with np.errstate(invalid="ignore"):  # an end may lie on the vanishing point of its line
        now = np.stack([_depths(lines.ends[:, 0], segments.axis, pixels, seen, turns) for pixels in at])
        there = np.stack([seen.depths(face, pixels) for pixels in at])
        near = there.max(axis=0) / there[1]
    sure = (likely[face] > own) & ((own < DOUBTFUL) | street[face])
    below = street | np.array([each.kind == "ground" for each in seen.face], bool)
    # Where a depth map has a line, it saw what is there; faces by their lines did not.
    heard = np.asarray(lines.by_depth_map, bool) if len(lines.by_depth_map) else np.zeros(len(lines), bool)
    must = ~heard & (now[1] > BEHIND * there[1]) & (likely[face] >= LEAST_LIKELY) & ((own < DOUBTFUL) | below[face])
    fits = near <= np.maximum(FURTHEST, STRETCHED * now.max(axis=0) / now[1])
    placed = (share >= LEAST_SHARE) & (sure | must) & (np.abs(there[1] / now[1] - 1) > APART) & fits
    lost = np.bincount(samples.row, before.lost, len(lines)) / np.bincount(samples.row) >= LEAST_SHARE
    return BetterPlaces(np.where(placed, face, NO_FACE), ~placed & lost & ~heard & (own < DOUBTFUL))


@dataclass(frozen=True, eq=False)
class _Before:
    """What is at M places of lines."""

    face: Int  # (M,) that the line can lie in there, NO_FACE for none: one on both sides, or where two meet
    lost: Bool  # (M,) what is there is before the line, which cannot lie in it
    seen: SeenFaces

    def most_of(self, count: int, row: Int) -> tuple[Int, Float]:
        """The face (N,) of the plane that most of a line's places are on, and their share (N,)."""
        _, plane = np.unique([plane.id for plane in self.seen.plane], return_inverse=True)
        found = np.zeros((count, len(plane)), np.int64)
        lies = self.face != NO_FACE
        np.add.at(found, (row[lies], self.face[lies]), 1)
        of_plane = found @ np.eye(plane.max() + 1, dtype=np.int64)[plane]
        best = of_plane.argmax(axis=1)
        face = np.where(plane == best[:, None], found, -1).argmax(axis=1)
        return face, of_plane.max(axis=1) / np.bincount(row, minlength=count)


def _before(samples: Samples, lines: Lines, seen: SeenFaces, turns: Turns) -> _Before:
    axis = np.asarray(lines.axis)[samples.row]
    sides = seen.beside(samples.pixel, samples.along)
    can = [can_lie(axis, seen.axis[face]) for face in sides]
    now = _depths(lines.ends[samples.row, 0], axis, samples.pixel, seen, turns)
    depth = [seen.depths(face, samples.pixel) for face in sides]
    with np.errstate(invalid="ignore"):
        apart = np.abs(depth[0] / depth[1] - 1)
        hidden = now > BEHIND * np.maximum(*depth)
    meet = np.logical_and(*(face != NO_FACE for face in sides)) & (apart <= APART)
    behind_things = now > BEHIND * seen.depths(seen.hidden_at(samples.pixel), samples.pixel)
    lies = np.where(sides[0] == sides[1], can[0], (meet | hidden) & (can[0] | can[1]))
    # Behind both, it is at most as far as the farther of the two.
    first = can[0] & ~(can[1] & hidden & (depth[1] > depth[0]))
    return _Before(np.where(lies, np.where(first, *sides), NO_FACE), (hidden & ~lies) | behind_things, seen)


def _street(seen: SeenFaces) -> Bool:
    """Which faces (F,) are a road, its kerbs or its pavement: the ground has two levels."""
    levels = {plane.id for plane in seen.plane if plane.shows_ground}
    kinds = [face.kind for face in seen.face]
    upright = [plane.axis != UP for plane in seen.plane]
    is_own = [kind == "ground" or (kind == "other" and up) for kind, up in zip(kinds, upright, strict=True)]
    return np.array(is_own, bool) & (len(levels) > 1)


def _depths(points: Float, axis: Int, pixels: Float, seen: SeenFaces, turns: Turns) -> Float:
    """Camera depth (M,) of lines along axes (M,) through points (M, 3), where pixels (M, 2) show them."""
    rays = world_rays(pixels, seen.camera.matrix, seen.axes)
    return depths_beside(rays, components(points, turns), axis)
