"""Where the photo shows what a person said about faces: outlines, px, that the page draws after a reload too."""

from typing import assert_never

import numpy as np

from linecad.arrays import Float
from linecad.corrections.edits import FaceEdit, NoWindow, Region, WallByEdges, Window
from linecad.directions import UP, components
from linecad.editing.state import Now
from linecad.geometry import homogeneous, project, world_rays
from linecad.model.openings.corners import on_wall
from linecad.model.openings.told import rectangles_on

Outline = list[list[float]]


def told_faces(now: Now) -> list[dict[str, object]]:
    """Each outline with what it `is`: a part of the photo, a window or door, or a wall; in the order of the edits."""
    return [
        {"is": word, "polygon": outline} for edit in now.lines.corrected.faces for word, outline in _outlines(edit, now)
    ]


def _outlines(edit: FaceEdit, now: Now) -> list[tuple[str, Outline]]:
    match edit:
        case Region():
            return [(edit.shows, [list(corner) for corner in edit.polygon])]
        case Window():
            return [(edit.kind, corners.tolist()) for corners in _windows(edit, now)]
        case WallByEdges():
            return [("wall", _wall(edit))]
        case NoWindow():
            return []
        case _:
            assert_never(edit)


def _windows(edit: Window, now: Now) -> list[Float]:
    """The corners (4, 2) of each window. How far away its wall is makes no difference to where the photo shows it."""
    camera, frame = now.found.camera, now.found.frame
    axis, rotation, turns = edit.wall.normal, frame.rotation, frame.turns
    ray = components(world_rays(np.array(edit.corners[:1]), camera.matrix, rotation), turns)[0]
    offset = float(np.copysign(1.0, ray[axis]))
    rectangles = rectangles_on(edit, (axis, offset), camera, rotation, turns)
    if isinstance(rectangles, str):
        return []
    corners = [np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]]) for u0, u1, v0, v1 in rectangles.tolist()]
    return [project(on_wall(flat, axis, offset, turns), camera.matrix, rotation) for flat in corners]


def _wall(edit: WallByEdges) -> Outline:
    """The corners, where an upright edge crosses a level one."""
    through = [(line.axis == UP, np.cross(*homogeneous(np.array(line.ends)))) for line in edit.lines]
    (left, right), (top, bottom) = ([line for is_up, line in through if is_up == wanted] for wanted in (True, False))
    corners = np.array([np.cross(*pair) for pair in ((left, top), (right, top), (right, bottom), (left, bottom))])
    found: Outline = (corners[:, :2] / corners[:, 2:]).tolist()
    return found
