"""The scale of a scene from the lengths that a person knows of its lines."""

from dataclasses import replace

import numpy as np

from linecad.arrays import Float
from linecad.corrections.apply import CorrectedLines
from linecad.directions import components
from linecad.geometry import depths_beside, world_rays
from linecad.scene import Scene

LENGTHS_DISAGREE = 1.05  # ratio of the scales that two known lengths give, above which a note says so


def measured(scene: Scene, corrected: CorrectedLines) -> Scene:
    """The scene with the scale that known lengths give it: the geometric mean of what each says.

    Only lengths on component 0 count, since the scales of the others are guesses.
    """
    if not corrected.lengths:
        return scene
    row = scene.lines.row_by_look
    scales, notes = [], []
    for number, metres in corrected.lengths.items():
        own = int(np.flatnonzero(corrected.ids == number)[0])
        key = (int(corrected.segments.axis[own]), corrected.segments.ends[own].tobytes())
        if key not in row or scene.lines.component[row[key]] != 0:
            notes.append(f"a line of known length ({metres:g} m) is not on component 0, so its length says nothing")
            continue
        scales.append(metres / _length(scene, row[key], corrected.segments.ends[own]))
    if scales and max(scales) > LENGTHS_DISAGREE * min(scales):
        notes.append(f"the known lengths disagree by up to {max(scales) / min(scales) - 1:.0%}; their mean is taken")
    metres_per_unit = float(np.exp(np.mean(np.log(scales)))) if scales else None
    source = (
        f"{len(scales)} known length{'s' if len(scales) > 1 else ''} of lines, so a unit is {metres_per_unit:.6g} m"
        if metres_per_unit
        else ""
    )
    return replace(scene, metres_per_unit=metres_per_unit, scale_source=source, notes=scene.notes + tuple(notes))


def _length(scene: Scene, row: int, segment: Float) -> float:
    """How long a line is in units of the scene, of one joined from pieces what its piece `segment` (2, 2) px shows."""
    ends, axis = scene.lines.ends[row], int(scene.lines.axis[row])
    if not len(scene.lines.pieces[row]):
        return float(np.linalg.norm(ends[1] - ends[0]))
    rays = components(world_rays(segment, scene.camera.matrix, scene.rotation), scene.turns)
    depth = depths_beside(rays, components(ends[[0, 0]], scene.turns), np.full(2, axis))
    return float(np.abs(np.diff(depth * rays[:, axis]))[0])
