"""Which lines are written, by what they are drawn for: --detail of the command line."""

from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from linecad.confidence import with_lines
from linecad.model.clean.sight import Sight
from linecad.model.frame_ends import with_ends_closed
from linecad.model.frames import framed_lines
from linecad.scene import DETAIL, OPENING, OUTLINE, Plane, Scene

Detail = Literal["none", "openings", "all"]
DETAILS: tuple[Detail, ...] = get_args(Detail)
_ROLES: dict[Detail, tuple[str, ...]] = {
    "none": (OUTLINE,),
    "openings": (OUTLINE, OPENING),
    "all": (OUTLINE, OPENING, DETAIL),
}


def keep_drawn(scene: Scene, detail: Detail) -> Scene:
    """The scene with the lines that `detail` asks for, and with all planes and faces.

    Ends that met a line that is left out, and nearly meet one that stays, go there. Planes stay as sure as all their
    lines made them. A note counts what was left out; where that is nothing, the scene comes back as it is.
    """
    kept = np.isin(scene.lines.role, _ROLES[detail])
    if kept.all():
        return scene
    rest = with_lines(replace(scene, planes=_with_what_lines_told(scene)), kept)
    sight = Sight.of(scene.camera, scene.rotation, None)
    closed = with_ends_closed(framed_lines(rest.lines, rest.intersections, scene.turns), sight)
    rest = replace(rest, lines=closed.in_world())
    what = "detail" if detail == "openings" else "openings and detail"
    note = f"{len(scene.lines) - len(rest.lines)} of {len(scene.lines)} lines are left out: they are {what}"
    return replace(rest, notes=(*scene.notes, note))


def _with_what_lines_told(scene: Scene) -> tuple[Plane, ...]:
    """The planes with the median probability of their lines; as they are where the scene tells none."""
    if not len(scene.lines.probability):
        return scene.planes
    told = dict(zip(scene.lines.id.tolist(), np.asarray(scene.lines.probability).tolist(), strict=True))
    return tuple(
        replace(plane, told=float(np.median([told[line] for line in plane.lines])))
        if plane.lines and plane.told is None
        else plane
        for plane in scene.planes
    )
