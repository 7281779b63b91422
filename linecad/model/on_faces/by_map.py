"""Lines that a depth map has elsewhere, on both of their sides.

One line of a facade may be wrong in itself: the railing of a balcony that seems to lie in the wall behind it, an edge
along a wrong axis. Faces are no help where they are made of the same lines. A map with walls that are off by a few
percent sees it where the line is off by more.
"""

from itertools import pairwise

import numpy as np

from linecad.arrays import Float
from linecad.directions import Turns, across, components
from linecad.geometry import PhotoLength, depths_beside, unit_normals, world_rays
from linecad.model.on_faces.places import Samples
from linecad.model.regions.mapped import MappedDepths
from linecad.scene import Camera, Lines

BESIDE = PhotoLength(10.0, floor=3.0)  # px to either side of a line, where the map is asked
LEAST_OFF = 0.12  # log depth of both sides from the line; what is nearer may be relief, or the map's error
MOST_OFF = 1.4  # the same, from which on something else is seen there, such as the far end of a street
LEAST_EVEN = 0.06  # median of how far the places of a side are off their middle, log depth
ONE_SURFACE = 0.1  # log depth, within which both sides are one; else the line is the edge of the nearer one
WIDEST = 0.035  # of a map's errors, log depth, from which on it moves no line: its walls are off as lines are
LEAST_HEARD = 0.5  # share of the places of each side where the map has a depth


def factors_by_map(lines: Lines, mapped: MappedDepths, camera: Camera, rotation: Float, turns: Turns) -> Float:
    """How many times as far (N,) lines in the world are where a map has them; 1 for all that it does not contradict.

    `rotation` (3, 3) takes world to camera, `turns` are of further frames.
    """
    factor = np.ones(len(lines))
    samples = Samples.of(lines.segment, camera.width)
    axis, directions = np.asarray(lines.axis)[samples.row], components(rotation, turns)
    rays = world_rays(samples.pixel, camera.matrix, directions)
    own = depths_beside(rays, components(lines.ends[samples.row, 0], turns), axis)
    beside = BESIDE.px(camera.width) * unit_normals(samples.along)
    on_line, *of_sides = (_off(mapped, samples.pixel + side * beside, own) for side in (0, -1, 1))
    normals = across(axis)
    towards = np.take_along_axis(rays, normals, axis=1)
    slants = []
    for side in (-1, 1):
        seen = world_rays(samples.pixel + side * beside, camera.matrix, directions)
        with np.errstate(divide="ignore", invalid="ignore"):  # of the depth on a plane over that on the line
            slants.append(np.log(towards / np.take_along_axis(seen, normals, axis=1)).T)
    off, slant = np.stack(of_sides), np.stack(slants, axis=1)
    for first, last in pairwise(np.flatnonzero(np.diff(samples.row, prepend=-1, append=-1)).tolist()):
        move = _move(on_line[first:last], off[:, first:last], slant[:, :, first:last])
        factor[samples.row[first]] = np.exp(move)
    return factor


def _off(mapped: MappedDepths, pixels: Float, own: Float) -> Float:
    """By which log (M,) the map is farther at pixels (M, 2) than lines there; not finite where it is mute."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.log(mapped.near(pixels) / own))


def _move(on_line: Float, off: Float, slant: Float) -> float:
    """Where a map puts a line of P places, relative to where it is, log depth; 0 if it leaves it there.

    By which log the map is farther on the line (P,), as on a bar before a wall, and on both of its sides (2, P); and by
    which log each plane that the line can lie in is farther there than the line (2, 2, P), NaN behind the camera.
    """
    on_line = on_line[np.isfinite(on_line)]
    if len(on_line) >= LEAST_HEARD * off.shape[1] and abs(np.median(on_line)) < LEAST_OFF:
        return 0.0
    with np.errstate(invalid="ignore"):
        by_plane = off - slant
    heard = (np.isfinite(by_plane).mean(axis=2) >= LEAST_HEARD).all(axis=1)
    if not heard.any():
        return 0.0
    by_plane = np.where(np.isfinite(by_plane), by_plane, np.nan)[heard]
    middles = np.nanmedian(by_plane, axis=2)
    apart = np.ptp(middles, axis=1)
    is_one = bool(apart.min() < ONE_SURFACE)
    # Beside an edge two surfaces are seen: the plane that is less oblique there says more of their depths.
    best = int(apart.argmin() if is_one else np.nanmedian(np.abs(slant[heard]), axis=(1, 2)).argmin())
    middle = middles[best]
    uneven = np.nanmedian(np.abs(by_plane[best] - middle[:, None]), axis=1)
    move, spread = (middle.mean(), uneven.min()) if is_one else (middle.min(), uneven[middle.argmin()])
    is_off = np.abs(middle).min() >= LEAST_OFF and abs(move) < MOST_OFF
    return float(move) if is_off and spread <= LEAST_EVEN else 0.0
