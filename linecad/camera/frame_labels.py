"""Which direction each segment runs along, where the segments beside it have a say.

Near the horizon all that is level looks alike: a short segment there fits x as well as y. And directions of
neighbouring houses are near to each other in much of a photo. But a facade runs along one of them: how usual each
direction is differs from place to place, and is that of the neighbours.
"""

import numpy as np
from scipy.spatial import cKDTree

from linecad.arrays import Float, Int
from linecad.camera.frame_mixture import Observed
from linecad.camera.horizontal_frames import HorizontalFrames
from linecad.geometry import reach_across, vanishing_points
from linecad.line_graph import Segments
from linecad.lines.segments import label_angle
from linecad.scene import Camera

NEIGHBOURS = 40  # segments about one whose directions it may share
ROUNDS = 12  # of asking the neighbours, who ask theirs; labels change no more
EVERYWHERE = 0.1  # of the share of a direction that is that of the whole photo


def label_by_frames(segments: Segments, camera: Camera, frames: HorizontalFrames) -> Int:
    """(N,) the direction that each segment most likely runs along, as its row in `frames.directions`, or -1."""
    if len(segments) < 2:
        return frames.labelled(segments, camera)
    seen = Observed(segments.ends, camera.focal, camera.matrix[:2, 2], camera.width, camera.height)
    directions = frames.directions
    # What goes on beyond a vanishing point is no line along its direction.
    points = vanishing_points(camera.matrix, directions.T)
    along = np.where(reach_across(segments.ends, points), 0.0, seen.density(directions))
    density = np.vstack([along, np.full(len(segments), 1 / np.pi)])
    share = _local_shares(segments, density, frames.shares)
    label = (share * density).argmax(axis=0)
    is_along = label < len(directions)
    sine = np.abs(seen.against(directions).sine)
    angle = np.take_along_axis(sine, np.where(is_along, label, 0)[None], axis=0)[0]
    labels: Int = np.where(is_along & (angle < np.sin(label_angle(camera.width))), label, -1)
    return labels


def _local_shares(segments: Segments, density: Float, usual: Float) -> Float:
    """How usual (M + 1, N) each direction, and none, is about each segment, with densities (M + 1, N)."""
    middle, length = segments.ends.mean(axis=1), segments.length
    beside = cKDTree(middle).query(middle, k=min(NEIGHBOURS + 1, len(middle)))[1][:, 1:]
    weight = length[beside] / length[beside].sum(axis=1, keepdims=True)
    share = np.repeat(usual[:, None], len(middle), axis=1)
    for _ in range(ROUNDS):
        belongs = share * density
        belongs = belongs[:-1] / belongs[:-1].sum(axis=0)
        about = (belongs[:, beside] * weight).sum(axis=2)
        # Whether a segment runs along any direction is no matter of place.
        share[:-1] = EVERYWHERE * usual[:-1, None] + (1 - EVERYWHERE) * (1 - usual[-1]) * about
    return share
