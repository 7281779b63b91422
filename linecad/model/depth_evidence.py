"""What the depth map that was given with a photo says of its faces, once the bodies are placed."""

import numpy as np

from linecad.arrays import Float
from linecad.depth.depth_map import camera_depths
from linecad.depth.normals import Normals
from linecad.geometry import homogeneous
from linecad.model.regions.mapped import MappedDepths
from linecad.ties.placing import Placed


def normals_of(placed: Placed | None) -> Normals | None:
    """The normals of a depth map that was not left out."""
    if placed is None or placed.depth_map is None or placed.depth_map.left_out:
        return None
    depth = placed.setting.sight.depth
    return None if depth is None else depth.normals


def depths_of(placed: Placed | None, scale: float, matrix: Float) -> MappedDepths | None:
    """The depths of a map that was not left out, in a scene of which the placed lines are `scale` times as far.

    `matrix` (3, 3) is K of the photo, px.
    """
    if placed is None or placed.depth_map is None or placed.depth_map.left_out:
        return None
    depth, told = placed.setting.sight.depth, placed.depth_map
    assert depth is not None
    assert told.kind is not None
    assert told.scale is not None
    assert told.width is not None
    v, u = np.mgrid[: depth.height, : depth.width]
    rays = homogeneous(np.stack([u, v], axis=2).astype(np.float64)) @ np.linalg.inv(matrix).T
    slant = np.linalg.norm(rays, axis=2)
    values = np.where(depth.valid, depth.values, np.nan).astype(np.float64)
    found = camera_depths(values, slant, told.kind, told.shift or 0.0)
    return MappedDepths(found * (scale / told.scale), told.width)
