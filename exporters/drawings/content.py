"""What drawings share: the lines of a scene with their layers, its openings in space, and which of them are guesses."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from exporters.bands import LEAST, LIKELY
from exporters.drawings.records import DETAILS, OPENINGS, OUTLINES, Layer, Unit
from exporters.model import Model, metres_per_unit
from linecad.arrays import Bool, Float, Text
from linecad.directions import UP, directions_of, partner
from linecad.scene import DETAIL, OPENING, OUTLINE, QUALITIES, Opening, Plane

LAYER_OF: dict[str, Layer] = {OUTLINE: OUTLINES, OPENING: OPENINGS, DETAIL: DETAILS}


@dataclass(frozen=True, eq=False)
class DrawnLines:
    """All lines of a model, in ascending id within their groups."""

    ends: Float  # (N, 2, 3) m
    roles: Text  # (N,)
    is_guess: Bool  # (N,) probably wrong; none where the scene does not tell


def lines_of(model: Model) -> DrawnLines:
    """The lines that a drawing may show."""
    groups = model.groups
    told = [group.probability if len(group.probability) else np.ones(len(group.ids)) for group in groups]
    return DrawnLines(
        np.concatenate([np.zeros((0, 2, 3)), *(group.ends for group in groups)]),
        np.concatenate([np.zeros(0, np.str_), *(group.roles for group in groups)]),
        np.concatenate([np.zeros(0), *told]) < LEAST[LIKELY],
    )


def guessed_planes(model: Model) -> set[int]:
    """Ids of planes that no line shows, or whose lines are guesses in the median; none where the scene does not tell.

    A plane without lines follows from where the lines of others end, and is a guess only where others are told. Lines
    that are left out of the drawing count as well.
    """
    lines = model.scene.lines
    if not len(lines.probability) and all(plane.told is None for plane in model.scene.planes):
        return set()
    told = dict(zip(lines.id.tolist(), np.asarray(lines.probability).tolist(), strict=True))

    def median(plane: Plane) -> float:
        if plane.told is not None:
            return plane.told
        return float(np.median([told[line] for line in plane.lines])) if plane.lines else 0.0

    return {plane.id for plane in model.scene.planes if median(plane) < LEAST[LIKELY]}


def corners_of(opening: Opening, model: Model) -> Float:
    """(4, 3) m, the corners of an opening in its wall: u0 v0, u1 v0, u1 v1, u0 v1."""
    scene = model.scene
    plane = next(each for each in scene.planes if each.id == opening.plane)
    directions = directions_of(scene.turns)
    u, v = directions[int(partner(plane.axis))], directions[UP]
    places = [(opening.u0, opening.v0), (opening.u1, opening.v0), (opening.u1, opening.v1), (opening.u0, opening.v1)]
    flat = np.array([plane.offset * directions[plane.axis] + across * u + up * v for across, up in places])
    return flat * metres_per_unit(scene) + model.eye


def is_metric(model: Model) -> bool:
    """Whether a length is known."""
    return model.scene.metres_per_unit is not None


def unit_of(model: Model, whole: float) -> Unit:
    """What lengths are told in: metres, or where none is known shares of `whole` drawing metres."""
    return Unit(1.0, 2, " m") if is_metric(model) else Unit(whole, 3, "")


def notes_of(model: Model, guessed: Sequence[str], whole: str) -> tuple[str, ...]:
    """Where lengths come from, what is guessed, then the scene's notes; `whole` is the length that is 1 without one."""
    scene = model.scene
    first = [] if is_metric(model) else [f"lengths are shares of {whole}, as none is known"]
    if scene.scale_source:
        first.append(f"scale: {scene.scale_source}")
    if scene.certainty is not None and scene.certainty.quality != QUALITIES[0]:
        first.append(f"camera {scene.certainty.quality}: {scene.certainty.reason}")
    return (*first, *guessed, *scene.notes)


def camera_line(model: Model) -> str:
    """The camera for the title block."""
    scene = model.scene
    sure = "" if scene.certainty is None else f"; camera {scene.certainty.quality}"
    return f"From one photo by linecad, focal length {scene.camera.focal:.0f} px{sure}"
