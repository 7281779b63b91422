"""Ids of lines that follow from where their segments lie in the photo (docs/decisions/0103).

An id is a place: of 45237, 45 says how far down and 23 how far right the middle of the line's longest segment lies, in
hundredths of the photo's longer side, and 7 tells it from the others there. So a line keeps its id when another option
or an edit elsewhere makes, joins or takes away lines, and only its neighbours may change theirs.
"""

from dataclasses import replace

import numpy as np

from linecad.arrays import Float, Int, rows_of
from linecad.scene import Camera, Lines, Scene

CELLS = 100  # along the photo's longer side
PLACES = 10  # ids of a cell; lines that find none there get those behind the last cell


def with_ids_by_place(scene: Scene) -> Scene:
    """The scene with such ids, wherever lines are named, and its lines in their order."""
    lines = scene.lines
    ids = ids_by_place(lines, scene.camera)
    known = dict(zip(lines.id.tolist(), ids.tolist(), strict=True))
    crossings = np.array([[known[line] for line in pair] for pair in scene.intersections.lines.tolist()], np.int64)
    return replace(
        scene,
        lines=rows_of(replace(lines, id=ids), np.argsort(ids)),
        intersections=replace(scene.intersections, lines=crossings.reshape(-1, 2)),
        planes=tuple(replace(plane, lines=tuple(known[line] for line in plane.lines)) for plane in scene.planes),
    )


def ids_by_place(lines: Lines, camera: Camera) -> Int:
    """(N,) the id of each line."""
    middle = np.array([_middle(lines.segments_of(row)) for row in range(len(lines))]).reshape(-1, 2)
    side = max(camera.width, camera.height) / CELLS
    column, row = np.clip(np.floor((middle + 0.5) / side), 0, CELLS - 1).astype(np.int64).T
    cell = row * CELLS + column
    order = np.lexsort((middle[:, 1], middle[:, 0], lines.axis, cell))
    ids = np.zeros(len(lines), np.int64)
    place = np.arange(len(order)) - np.searchsorted(cell[order], cell[order])
    ids[order] = cell[order] * PLACES + place
    crowded = order[place >= PLACES]
    ids[crowded] = CELLS * CELLS * PLACES + np.arange(len(crowded))
    return ids


def _middle(segments: Float) -> Float:
    """(2,) px of the longest of segments (K, 2, 2), the first of several."""
    longest = segments[int(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).argmax())]
    middle: Float = longest.mean(axis=0)
    return middle
