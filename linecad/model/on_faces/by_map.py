"""Lines that a depth map has elsewhere, on both of their sides.

One line of a facade may be wrong in itself: the railing of a balcony that seems to lie in the wall behind it, an edge
along a wrong axis. Faces are no help where they are made of the same lines. A map with walls that are off by a few
percent sees it where the line is off by more.
"""

import numpy as np

from linecad.arrays import Float
from linecad.directions import Turns, components
from linecad.geometry import PhotoLength, depths_beside, unit_normals, world_rays
from linecad.model.on_faces.places import Samples
from linecad.model.regions.mapped import MappedDepths
from linecad.scene import Camera, Lines

BESIDE = PhotoLength(10.0, floor=3.0)  # px to either side of a line, where the map is asked
LEAST_OFF = 0.12  # log depth of both sides from the line; what is nearer may be relief, or the map's error
LEAST_EVEN = 0.06  # median of how far the places of the more even side are off their middle, log depth
ONE_SURFACE = 0.1  # log depth, within which both sides are one; else the line is the edge of the nearer one
WIDEST = (
    0.035  # of a map's errors, log depth, from which on it moves no line: its walls are off by as much as lines are
)
LEAST_HEARD = 0.5  # share of the places of each side where the map has a depth


def factors_by_map(lines: Lines, mapped: MappedDepths, camera: Camera, rotation: Float, turns: Turns) -> Float:
    """How many times as far (N,) lines in the world are where a map has them; 1 for all that it does not contradict.

    `rotation` (3, 3) takes world to camera, `turns` are of further frames.
    """
    factor = np.ones(len(lines))
    samples = Samples.of(lines.segment, camera.width)
    rays = world_rays(samples.pixel, camera.matrix, components(rotation, turns))
    axis = np.asarray(lines.axis)[samples.row]
    own = depths_beside(rays, components(lines.ends[samples.row, 0], turns), axis)
    across = BESIDE.px(camera.width) * unit_normals(samples.along)
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.stack([np.log(mapped.near(samples.pixel + side * across) / own) for side in (-1, 1)])
    starts = np.flatnonzero(np.diff(samples.row, prepend=-1))
    for places in np.split(np.arange(len(samples.row)), starts[1:]):
        factor[samples.row[places[0]]] = np.exp(_move(off[:, places]))
    return factor


def _move(off: Float) -> float:
    """Where both sides (2, P) of a line put it, relative to where it is, log depth; 0 if they leave it there."""
    if (np.isfinite(off).mean(axis=1) < LEAST_HEARD).any():
        return 0.0
    off = np.where(np.isfinite(off), off, np.nan)
    middle = np.nanmedian(off, axis=1)
    uneven = np.nanmedian(np.abs(off - middle[:, None]), axis=1)
    if np.abs(middle).min() < LEAST_OFF or uneven.min() > LEAST_EVEN:
        return 0.0
    return float(middle.mean() if np.ptp(middle) < ONE_SURFACE else middle.min())
