"""The scale of a scene from lengths that a person knows: of its lines, and between points of its lines and faces."""

from dataclasses import replace

import numpy as np

from linecad.arrays import Float
from linecad.corrections.corrected import CorrectedLines, FoundPlace
from linecad.directions import components
from linecad.errors import ScaleError
from linecad.geometry import depths_beside, world_rays
from linecad.model.scale import SHORTEST, UNSURE, UNSURE_PLANE, is_measurable, measurable, nearest_on_line, seen_plane
from linecad.scene import Scene

SAYS_NOTHING = "its length says nothing about the scale"  # of notes on lengths, also for who looks for them
DISAGREE = "the known lengths disagree"
LENGTHS_DISAGREE = 1.05  # ratio of the scales that two known lengths give, above which a note says so
GRAZING = 1e-6  # of a ray's part across a plane; what is less meets it nowhere


def measured(scene: Scene, corrected: CorrectedLines) -> Scene:
    """The scene with the scale that known lengths give it: the geometric mean of what each says.

    A note tells of each that says nothing (`measurable`).
    """
    if not corrected.lengths and not corrected.distances:
        return scene
    row, tells = scene.lines.row_by_look, measurable(scene)
    scales, notes = [], []
    for number, metres in corrected.lengths.items():
        key = _look(corrected, number)
        if key not in row or not tells[row[key]]:
            why = "is not in the model" if key not in row else UNSURE
            notes.append(f"a line of known length ({metres:g} m) {why}, so {SAYS_NOTHING}")
            continue
        scales.append(metres / _length(scene, row[key], corrected, number))
    for first, second, metres in corrected.distances:
        try:
            scales.append(metres / units_between(scene, corrected, (first, second)))
        except ScaleError as error:
            notes.append(f"a known distance ({metres:g} m) says nothing: {error}")
    if scales and max(scales) > LENGTHS_DISAGREE * min(scales):
        notes.append(f"{DISAGREE} by up to {max(scales) / min(scales) - 1:.0%}; their mean is taken")
    metres_per_unit = float(np.exp(np.mean(np.log(scales)))) if scales else None
    source = _source(corrected, len(scales), metres_per_unit) if metres_per_unit else ""
    return replace(scene, metres_per_unit=metres_per_unit, scale_source=source, notes=scene.notes + tuple(notes))


def units_between(scene: Scene, corrected: CorrectedLines, places: tuple[FoundPlace, FoundPlace]) -> float:
    """How far apart two points are, in units of the scene; ScaleError where it has no such point, or not for sure."""
    first, second = (_point(scene, corrected, place) for place in places)
    units = float(np.linalg.norm(second - first))
    if not units > SHORTEST * float(np.linalg.norm(first)):
        raise ScaleError("its two points are one; choose two others")
    return units


def _point(scene: Scene, corrected: CorrectedLines, place: FoundPlace) -> Float:
    """(3,) in the world."""
    u, v = place.pixel
    ray = world_rays(np.array(place.pixel), scene.camera.matrix, scene.rotation)
    if place.line is not None:
        row = scene.lines.row_by_look.get(_look(corrected, place.line))
        if row is None or not measurable(scene)[row]:
            raise ScaleError(f"the line at {u:.0f},{v:.0f} px {UNSURE}")
        point: Float = nearest_on_line(ray[None], scene.lines.ends[row])[0]
        return point
    # A place is on a line or in a plane.
    assert place.face is not None
    plane = seen_plane(scene, place.face, place.normal)
    if plane is None:
        raise ScaleError(f"no face that a person measured on is at {place.face[0]:.0f},{place.face[1]:.0f} px any more")
    if not is_measurable(scene, plane):
        raise ScaleError(f"plane {plane.id} {UNSURE_PLANE}")
    along = float(plane.along_normal(ray, scene.turns))
    if along * plane.offset <= GRAZING * abs(plane.offset) * float(np.linalg.norm(ray)):
        raise ScaleError(f"the ray of {u:.0f},{v:.0f} px does not meet plane {plane.id}")
    met: Float = ray * (plane.offset / along)
    return met


def _look(corrected: CorrectedLines, number: int) -> tuple[int, bytes]:
    """Axis and segment of a line by its id."""
    own = int(np.flatnonzero(corrected.ids == number)[0])
    return int(corrected.segments.axis[own]), corrected.segments.ends[own].tobytes()


def _length(scene: Scene, row: int, corrected: CorrectedLines, number: int) -> float:
    """How long a line is in units of the scene, of one joined from pieces what the piece of that id shows."""
    ends, axis = scene.lines.ends[row], int(scene.lines.axis[row])
    if not len(scene.lines.pieces[row]):
        return float(np.linalg.norm(ends[1] - ends[0]))
    segment = corrected.segments.ends[corrected.ids == number][0]
    rays = components(world_rays(segment, scene.camera.matrix, scene.rotation), scene.turns)
    depth = depths_beside(rays, components(ends[[0, 0]], scene.turns), np.full(2, axis))
    return float(np.abs(np.diff(depth * rays[:, axis]))[0])


def _source(corrected: CorrectedLines, count: int, metres_per_unit: float) -> str:
    what = " of lines" if not corrected.distances else ""
    return f"{count} known length{'s' if count > 1 else ''}{what}, so a unit is {metres_per_unit:.6g} m"
