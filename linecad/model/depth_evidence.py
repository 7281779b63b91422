"""What the depth map that was given with a photo says of its faces, once the bodies are placed."""

import numpy as np

from linecad.arrays import Float
from linecad.depth.normals import Normals
from linecad.model.regions.mapped import MappedDepths
from linecad.ties.depth_ties import DepthWitness
from linecad.ties.placing import Placed


def normals_of(placed: Placed | None) -> Normals | None:
    """The normals of a depth map that was not left out."""
    if placed is None or placed.depth_map is None or placed.depth_map.left_out:
        return None
    depth = placed.setting.sight.depth
    return None if depth is None else depth.normals


def depths_of(placed: Placed | None, scale: float, matrix: Float) -> MappedDepths | None:
    """What a map that was not left out says, in a scene of which the placed lines are `scale` times as far.

    `matrix` (3, 3) is K of the photo, px.
    """
    if placed is None or placed.depth_map is None or placed.depth_map.left_out:
        return None
    depth, told = placed.setting.sight.depth, placed.depth_map
    assert depth is not None
    assert told.kind is not None
    assert told.scale is not None
    assert told.width is not None
    heard = placed.places.evidence.heard
    exact = heard.width_of_parts if isinstance(heard, DepthWitness) else np.inf
    return MappedDepths(depth, told.kind, told.shift or 0.0, scale / told.scale, matrix, told.width, exact)
