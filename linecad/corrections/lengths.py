"""The scale of a scene from the lengths that a person knows of its lines."""

from dataclasses import replace

import numpy as np

from exporters.bands import GUESS, bands_of
from linecad.arrays import Bool, Float
from linecad.corrections.apply import CorrectedLines
from linecad.directions import components
from linecad.geometry import depths_beside, world_rays
from linecad.scene import Scene

SAYS_NOTHING = "its length says nothing about the scale"  # of notes on lengths, also for who looks for them
DISAGREE = "the known lengths disagree"
UNSURE = "stands at a depth that is a guess"
LENGTHS_DISAGREE = 1.05  # ratio of the scales that two known lengths give, above which a note says so


def measured(scene: Scene, corrected: CorrectedLines) -> Scene:
    """The scene with the scale that known lengths give it: the geometric mean of what each says.

    A note tells of each that says nothing (`measurable`).
    """
    if not corrected.lengths:
        return scene
    axes = enumerate(scene.lines.axis.tolist())
    row = {(axis, ends.tobytes()): number for number, axis in axes for ends in scene.lines.segments_of(number)}
    tells, scales, notes = measurable(scene), [], []
    for number, metres in corrected.lengths.items():
        own = int(np.flatnonzero(corrected.ids == number)[0])
        key = (int(corrected.segments.axis[own]), corrected.segments.ends[own].tobytes())
        if key not in row or not tells[row[key]]:
            why = "is not in the model" if key not in row else UNSURE
            notes.append(f"a line of known length ({metres:g} m) {why}, so {SAYS_NOTHING}")
            continue
        scales.append(metres / _length(scene, row[key], corrected.segments.ends[own]))
    if scales and max(scales) > LENGTHS_DISAGREE * min(scales):
        notes.append(f"{DISAGREE} by up to {max(scales) / min(scales) - 1:.0%}; their mean is taken")
    metres_per_unit = float(np.exp(np.mean(np.log(scales)))) if scales else None
    source = (
        f"{len(scales)} known length{'s' if len(scales) > 1 else ''} of lines, so a unit is {metres_per_unit:.6g} m"
        if metres_per_unit
        else ""
    )
    return replace(scene, metres_per_unit=metres_per_unit, scale_source=source, notes=scene.notes + tuple(notes))


def measurable(scene: Scene) -> Bool:
    """(N,) whether the length of each line says how long a unit is: where its depth is no guess.

    Where the scene tells probabilities, all components have one scale, and a length is as far off as the depth of its
    line is (docs/decisions/0108); where it tells none, each has a scale of its own, and only component 0 is measured.
    """
    bands = bands_of(scene.lines)
    tells: Bool = scene.lines.component == 0 if bands is None else bands != GUESS
    return tells


def _length(scene: Scene, row: int, segment: Float) -> float:
    """How long a line is in units of the scene, of one joined from pieces what its piece `segment` (2, 2) px shows."""
    ends, axis = scene.lines.ends[row], int(scene.lines.axis[row])
    if not len(scene.lines.pieces[row]):
        return float(np.linalg.norm(ends[1] - ends[0]))
    rays = components(world_rays(segment, scene.camera.matrix, scene.rotation), scene.turns)
    depth = depths_beside(rays, components(ends[[0, 0]], scene.turns), np.full(2, axis))
    return float(np.abs(np.diff(depth * rays[:, axis]))[0])
