"""A scene without the lines whose depth is not sure enough, by the probability that it is right."""

from dataclasses import fields, replace
from typing import TypeVar

import numpy as np

from linecad.arrays import Bool
from linecad.errors import ConfidenceError
from linecad.scene import Intersections, Lines, Plane, Scene

Record = TypeVar("Record", Lines, Intersections)


def keep_probable(scene: Scene, least: float) -> Scene:
    """The scene of the lines whose probability is at least `least` (0 to 1), everything else by its id as before.

    With a line go its crossings and its place in planes. A plane goes, with its faces, where none of its lines stays;
    where one stays, all its faces do. Openings go with the planes of their walls.
    A note counts what was left out; where that is nothing, the scene comes back as it is. Raises ConfidenceError where
    the scene tells no probabilities, or no line is left.
    """
    lines = scene.lines
    if not len(lines.probability):
        raise ConfidenceError(
            "the scene does not tell how likely the depth of its lines is right; leave out --confidence, "
            "or convert the photo again with the default options"
        )
    probability = np.asarray(lines.probability)
    kept = probability >= least
    if kept.all():
        return scene
    if not kept.any():
        raise ConfidenceError(
            f"no line has a depth that is right with a probability of {least:g} or more, the highest is "
            f"{probability.max():.3g}; choose a smaller --confidence"
        )
    ids = set(lines.id[kept].tolist())
    crossings = scene.intersections
    both = np.asarray(np.isin(crossings.lines, list(ids)).all(axis=1))
    planes = tuple(plane for plane in (_plane_of(each, ids) for each in scene.planes) if plane.lines)
    return replace(
        scene,
        lines=_rows(lines, kept),
        intersections=_rows(crossings, both),
        planes=planes,
        openings=tuple(opening for opening in scene.openings if opening.plane in {plane.id for plane in planes}),
        notes=(*scene.notes, _note(scene, int(kept.sum()), len(planes), least)),
    )


def _rows(record: Record, kept: Bool) -> Record:
    """The masked entries of every field of a record of arrays."""
    return replace(record, **{each.name: np.asarray(getattr(record, each.name))[kept] for each in fields(record)})


def _plane_of(plane: Plane, ids: set[int]) -> Plane:
    return replace(plane, lines=tuple(line for line in plane.lines if line in ids))


def _note(scene: Scene, lines: int, planes: int, least: float) -> str:
    """What was left out, of a scene of which so many lines and planes stay."""
    gone = f"{len(scene.lines) - lines} of {len(scene.lines)} lines"
    if planes < len(scene.planes):
        gone += f" and {len(scene.planes) - planes} of {len(scene.planes)} planes"
    return f"{gone} are left out: the probability that their depth is right is below {least:g}"
