"""A scene without the lines whose depth is not sure enough, by the probability that it is right."""

from dataclasses import replace

import numpy as np

from linecad.arrays import Bool
from linecad.errors import ConfidenceError
from linecad.scene import Intersections, Lines, Plane, Scene


def keep_probable(scene: Scene, least: float) -> Scene:
    """The scene of the lines whose probability is at least `least` (0 to 1), everything else by its id as before.

    With a line go its crossings and its place in planes. A plane goes, with its faces, where none of its lines stays;
    where one stays, all its faces do. A note counts what was left out; where that is nothing, the scene comes back as
    it is. Raises ConfidenceError where the scene tells no probabilities, or no line is left.
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
    planes = tuple(plane for plane in (_plane_of(each, ids) for each in scene.planes) if plane.lines)
    return replace(
        scene,
        lines=_lines_of(lines, kept),
        intersections=_crossings_of(scene.intersections, ids),
        planes=planes,
        notes=(*scene.notes, _note(scene, int(kept.sum()), len(planes), least)),
    )


def _lines_of(lines: Lines, kept: Bool) -> Lines:
    return Lines(
        id=lines.id[kept],
        axis=lines.axis[kept],
        segment=lines.segment[kept],
        ends=lines.ends[kept],
        is_boundary=lines.is_boundary[kept],
        component=lines.component[kept],
        confidence=lines.confidence[kept],
        probability=np.asarray(lines.probability)[kept],
    )


def _crossings_of(crossings: Intersections, ids: set[int]) -> Intersections:
    """The crossings of two lines that are both kept."""
    kept = np.isin(crossings.lines, list(ids)).all(axis=1)
    return Intersections(
        lines=crossings.lines[kept],
        kind=crossings.kind[kept],
        pixel=crossings.pixel[kept],
        real=crossings.real[kept],
        in_tree=crossings.in_tree[kept],
        weight=crossings.weight[kept],
        reason=np.asarray(crossings.reason)[kept],
    )


def _plane_of(plane: Plane, ids: set[int]) -> Plane:
    return replace(plane, lines=tuple(line for line in plane.lines if line in ids))


def _note(scene: Scene, lines: int, planes: int, least: float) -> str:
    """What was left out, of a scene of which so many lines and planes stay."""
    gone = f"{len(scene.lines) - lines} of {len(scene.lines)} lines"
    if planes < len(scene.planes):
        gone += f" and {len(scene.planes) - planes} of {len(scene.planes)} planes"
    return f"{gone} are left out: the probability that their depth is right is below {least:g}"
