"""Lines with the sky on both sides: wires, branches and rims of clouds, which are no part of a building."""

import numpy as np
import shapely

from linecad.arrays import Bool
from linecad.directions import UP
from linecad.geometry import PhotoLength, lengths, unit_normals
from linecad.model.on_faces.places import Samples
from linecad.scene import Camera, Lines

BESIDE = (PhotoLength(40.0), PhotoLength(96.0))  # px to either side; below the rail of a balcony there is less sky
LEAST_SHARE = 0.6  # of a line that must have the sky on both sides
LONG = PhotoLength(160.0)  # px; a shorter one that is likelier right than wrong may be a ledge against the sky
LIKELY = 0.5


def in_the_sky(lines: Lines, sky: shapely.Geometry, camera: Camera) -> Bool:
    """Which lines (N,) have the sky (px) on both sides wherever the photo shows them. Uprights may be masts."""
    found, width = np.zeros(len(lines), bool), camera.width
    rows = np.flatnonzero(np.asarray(lines.axis) != UP)
    if shapely.is_empty(sky) or len(rows) == 0:
        return found
    shapely.prepare(sky)
    shown = [lines.segments_of(row) for row in rows.tolist()]
    pieces, line = np.concatenate(shown), np.repeat(np.arange(len(rows)), [len(each) for each in shown])
    samples = Samples.of(pieces, width)
    across = unit_normals(samples.along)
    both = np.ones(len(across), bool)
    for side in (side * off.px(width) for off in BESIDE for side in (-1, 1)):
        # Beyond the photo's border the sky goes on.
        place = np.clip(samples.pixel + side * across, 0.0, [width - 1.0, camera.height - 1.0])
        both &= shapely.contains_xy(sky, place)
    own = np.bincount(line[samples.row], both, len(rows)) / np.bincount(line[samples.row], minlength=len(rows))
    long = np.bincount(line, lengths(pieces[:, 1] - pieces[:, 0])) >= LONG.px(width)
    doubtful = np.asarray(lines.probability)[rows] < LIKELY if len(lines.probability) else np.zeros(len(rows), bool)
    found[rows] = (own >= LEAST_SHARE) & (long | doubtful)
    return found
