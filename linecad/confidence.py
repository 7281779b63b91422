"""A scene without the lines whose depth is not sure enough, by the probability that it is right."""

from dataclasses import replace

import numpy as np

from linecad.arrays import Bool, rows_of
from linecad.errors import ConfidenceError
from linecad.scene import Opening, Plane, Scene


def keep_probable(scene: Scene, least: float) -> Scene:
    """The scene of the lines whose probability is at least `least` (0 to 1), everything else by its id as before.

    With a line go its crossings and its place in planes. A plane goes, with its faces, where none of its lines stays;
    where one stays, all its faces do. The ground stays, since all stand on it: heights are told from there. Openings
    go, with their panes and reveals, with the planes of their walls, and so do roofs.
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
    rest = with_lines(scene, kept)
    bare = {plane.id for plane in scene.planes if not plane.lines}  # as reveals are
    staying = {plane.id for plane in rest.planes if plane.lines or plane.id in bare or plane.shows_ground}
    staying -= {roof for roof, wall in scene.walls_of_roofs.items() if wall not in staying}
    openings = tuple(each for each in scene.openings if each.plane in staying)
    planes = _with_parts_of(openings, rest.planes, staying)
    note = _note(scene, int(kept.sum()), len(planes), least)
    return replace(rest, planes=planes, openings=openings, notes=(*scene.notes, note))


def with_lines(scene: Scene, kept: Bool) -> Scene:
    """The scene of the masked lines (N,), by their ids as before, with all planes and the crossings between them."""
    ids = set(scene.lines.id[kept].tolist())
    crossings = scene.intersections
    both = np.asarray(np.isin(crossings.lines, list(ids)).all(axis=1))
    planes = tuple(_plane_of(plane, ids) for plane in scene.planes)
    return replace(scene, lines=rows_of(scene.lines, kept), intersections=rows_of(crossings, both), planes=planes)


def _plane_of(plane: Plane, ids: set[int]) -> Plane:
    return replace(plane, lines=tuple(line for line in plane.lines if line in ids))


def _with_parts_of(openings: tuple[Opening, ...], planes: tuple[Plane, ...], staying: set[int]) -> tuple[Plane, ...]:
    """The `staying` planes (ids) without parts of other openings, and of the others what is part of an opening."""
    known = {each.id for each in openings}
    found = []
    for plane in planes:
        is_whole = plane.id in staying
        faces = tuple(face for face in plane.faces if face.opening in known or (is_whole and face.opening is None))
        if faces or (is_whole and not (plane.faces and not plane.lines)):
            found.append(replace(plane, faces=faces))
    return tuple(found)


def _note(scene: Scene, lines: int, planes: int, least: float) -> str:
    """What was left out, of a scene of which so many lines and planes stay."""
    gone = f"{len(scene.lines) - lines} of {len(scene.lines)} lines"
    if planes < len(scene.planes):
        gone += f" and {len(scene.planes) - planes} of {len(scene.planes)} planes"
    return f"{gone} are left out: the probability that their depth is right is below {least:g}"
