"""Which group of lines a scene is about: component 0, by its share of the photo, or as a person says.

A group, or component, is what real crossings connect. Depths are told relative to component 0, and where no
probabilities are told known lengths are measured in it alone.
"""

from dataclasses import replace
from typing import Literal, get_args

import numpy as np
import shapely

from linecad.confidence import with_lines
from linecad.errors import GroupError
from linecad.geometry import world_rays
from linecad.model.scale import depth_on_face
from linecad.scene import Scene

Groups = Literal["main", "all"]
GROUPS: tuple[Groups, ...] = get_args(Groups)
REACH = 0.004  # of the photo's longer side: a line that is nearer to a place in the photo is what stands there


def with_main_first(scene: Scene) -> Scene:
    """The scene with the component that most of the photo shows, and shows well, as component 0.

    What counts is the length of its segments in the photo times the probability of their depths, so that a far tower
    of many short lines is not what the scene is about. A scene that tells no probabilities comes back as it is: there
    the scales of the others are guesses relative to component 0.
    """
    lines = scene.lines
    if not len(lines.probability):
        return scene
    length = np.linalg.norm(lines.segment[:, 1] - lines.segment[:, 0], axis=1)
    return _with_first(scene, int(np.bincount(lines.component, length * np.asarray(lines.probability)).argmax()))


def choose_main(scene: Scene, pixel: tuple[float, float]) -> Scene:
    """The scene with the component that stands at a place in the photo (px) as component 0.

    That is the component of the nearest line there, else of the face that the photo shows there. Where the scales of
    components are guesses (formulations other than bodies), a known length is forgotten: it was of the other one.
    Raises GroupError where nothing stands there.
    """
    found = _component_at(scene, pixel)
    if found == 0:
        return scene
    chosen = _with_first(scene, found)
    note = f"component 0 is what stands at {pixel[0]:g},{pixel[1]:g} px; it was component {found}"
    if len(scene.lines.probability):
        note += "; probabilities are still those relative to the former one"
    elif scene.metres_per_unit is not None:
        chosen = replace(chosen, metres_per_unit=None, scale_source="")
        note += "; the known length was of the former one, so the scale is free again"
    return replace(chosen, notes=(*chosen.notes, note))


def keep_main(scene: Scene) -> Scene:
    """The scene of the lines, planes and openings of component 0.

    The ground stays, since all stand on it, and so does a plane that has neither lines nor faces. A note counts the
    lines that were left out; where that is nothing, the scene comes back as it is.
    """
    kept = scene.lines.component == 0
    if kept.all():
        return scene
    of_plane, of_face = scene.components_of_planes, scene.components_of_faces
    rest = with_lines(scene, kept)
    planes = []
    for before, plane in zip(scene.planes, rest.planes, strict=True):
        faces = tuple(face for face in plane.faces if of_face[face.id] == 0)
        if faces or plane.lines or not (before.faces or before.lines):
            planes.append(replace(plane, faces=faces))
    openings = tuple(each for each in scene.openings if of_plane[each.plane] == 0)
    note = f"{len(scene.lines) - int(kept.sum())} of {len(scene.lines)} lines are left out: they are not of component 0"
    return replace(rest, planes=tuple(planes), openings=openings, notes=(*scene.notes, note))


def _with_first(scene: Scene, first: int) -> Scene:
    """The scene with component `first` as component 0; those before it move up by one."""
    if first == 0:
        return scene
    lines = scene.lines
    number = np.where(lines.component < first, lines.component + 1, lines.component)
    component = np.where(lines.component == first, 0, number)
    confidence = np.where(
        lines.component == first, "supported", np.where(lines.component == 0, "weak", lines.confidence)
    )
    return replace(scene, lines=replace(lines, component=component, confidence=confidence))


def _component_at(scene: Scene, pixel: tuple[float, float]) -> int:
    lines, point = scene.lines, shapely.Point(pixel)
    off = shapely.distance(shapely.linestrings(lines.segment), point) if len(lines) else np.zeros(0)
    if len(off) and off.min() <= REACH * max(scene.camera.width, scene.camera.height):
        return int(lines.component[off.argmin()])
    ray = world_rays(np.array([pixel]), scene.camera.matrix, scene.rotation)[0]
    met = [
        (depth, face.id)
        for plane, face in scene.faces
        if (depth := depth_on_face(ray, plane, face, scene.turns)) is not None
    ]
    if not met:
        raise GroupError(
            f"no line and no face stands at {pixel[0]:g},{pixel[1]:g} px; choose a place on what the scene is about"
        )
    return scene.components_of_faces[min(met)[1]]
