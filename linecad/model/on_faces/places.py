"""Stretches of image lines on faces, and where they are in space."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import Turns, components, frame_axes, frame_of, lies_across
from linecad.geometry import PhotoLength, lengths, world_rays
from linecad.line_graph import Segments
from linecad.lines.details import LEAST_STRETCH
from linecad.model.on_faces.seen import NO_FACE, SeenFaces

STEP = PhotoLength(16.0, floor=4.0)  # px between the places of a line that are looked at
GAP = 1  # places in a row that may show another face, such as a bar across


@dataclass(frozen=True, eq=False)
class Samples:
    """M places along N segments, in their order."""

    row: Int  # (M,) segment
    pixel: Float  # (M, 2)
    share: Float  # (M,) of the way from the first end to the second
    along: Float  # (M, 2) px, from end to end

    @classmethod
    def of(cls, ends: Float, width: int) -> "Samples":
        """Places STEP apart along segments (N, 2, 2) of a photo of that width, two at least on each."""
        count = np.maximum(2, (lengths(ends[:, 1] - ends[:, 0]) / STEP.px(width)).astype(np.int64))
        row = np.repeat(np.arange(len(ends)), count)
        share = (np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[row]
        along = (ends[:, 1] - ends[:, 0])[row]
        return cls(row, ends[row, 0] + share[:, None] * along, share, along)


@dataclass(frozen=True, eq=False)
class Stretches:
    """P stretches of segments, each on one face."""

    row: Int  # (P,) segment
    face: Int  # (P,)
    share: Float  # (P, 2) from where to where along the segment

    def segments(self, segments: Segments) -> Segments:
        """The stretches themselves."""
        start, along = segments.ends[self.row, 0], segments.ends[self.row, 1] - segments.ends[self.row, 0]
        return Segments(start[:, None] + self.share[..., None] * along[:, None], segments.axis[self.row])


def stretches(samples: Samples, face: Int, segments: Segments, width: int) -> Stretches:
    """The runs of places that show one face (M,), NO_FACE for none, and are worth a line in a photo of that width."""
    least = LEAST_STRETCH.px(width)
    rows, faces, shares = [], [], []
    half = 0.5 / np.bincount(samples.row, minlength=len(segments))
    length = segments.length
    starts = np.unique(samples.row, return_index=True)[1]
    for first, last in pairwise([*starts.tolist(), len(samples.row)]):
        row, own = int(samples.row[first]), face[first:last]
        for number in np.unique(own[own != NO_FACE]).tolist():
            for low, high in _runs(own == number):
                share = (samples.share[first + low] - half[row], samples.share[first + high] + half[row])
                if (share[1] - share[0]) * length[row] >= least:
                    rows.append(row)
                    faces.append(number)
                    shares.append(share)
    return Stretches(np.array(rows, np.int64), np.array(faces, np.int64), np.array(shares).reshape(-1, 2))


def _runs(shows: Bool) -> list[tuple[int, int]]:
    """First and last place of each run in which at most GAP places in a row do not show it."""
    places = np.flatnonzero(shows)
    breaks = np.flatnonzero(np.diff(places) > GAP + 1)
    return list(zip(places[np.r_[0, breaks + 1]].tolist(), places[np.r_[breaks, -1]].tolist(), strict=True))


def can_lie(axis: Int, normal: Int) -> Bool:
    """Which lines along axes (M,) can lie in planes of those normals (M,), -1 for none."""
    return (normal >= 0) & lies_across(axis, np.maximum(normal, 0))


def in_space(segments: Segments, face: Int, seen: SeenFaces, rotation: Float, turns: Turns) -> tuple[Float, Int]:
    """The ends (N, 2, 3) of segments on the planes of their faces (N,), in the axes of the frame (N,) of each line.

    An upright line has the frame of its wall. The coordinate that its plane gives a line is that of the plane.
    """
    normal = seen.axis[face]
    frame = np.maximum(frame_of(segments.axis), frame_of(normal))
    rays = world_rays(segments.ends, seen.camera.matrix, rotation)
    ends = np.zeros((len(segments), 2, 3))
    for row in range(len(segments)):
        axes = frame_axes(int(frame[row]))
        plane, along = axes.index(int(normal[row])), axes.index(int(segments.axis[row]))
        offset = seen.plane[face[row]].offset
        reach = offset / components(rays[row], turns)[:, normal[row]]
        points = components(rays[row] * reach[:, None], turns)[:, axes]
        points[:, plane] = offset
        third = 3 - plane - along
        points[:, third] = points[:, third].mean()
        ends[row] = points
    return ends, frame
