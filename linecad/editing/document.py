"""The state of a session as the JSON that the page draws."""

import math
from functools import lru_cache

import numpy as np

from exporters.formats import FORMATS, SCENE_FILE
from linecad.camera.text import summary
from linecad.corrections.annotations import Annotations
from linecad.depth.depth_map import DepthMap
from linecad.directions import axis_name
from linecad.editing.bodies import ShownBodies
from linecad.editing.body_document import facts_of_page, list_bodies, moved_by_last
from linecad.editing.cell_layer import document_of_cells
from linecad.editing.depth_layers import document_of_layers
from linecad.editing.faces import facades_in, triangles_of
from linecad.editing.groups import Group, groups_of
from linecad.editing.in_model import is_guess
from linecad.editing.notes import notes_of
from linecad.editing.state import Decisions, Model, Now
from linecad.editing.tiles import TILE
from linecad.editing.told_faces import told_faces
from linecad.line_graph import LineGraph
from linecad.model.scale import measurable
from linecad.scene import Face, Plane, Scene

NOT_IN_SPACE: dict[str, object] = {
    "ends": None, "boundary": False, "component": -1, "confidence": None, "probability": None, "guess": False,
    "by_depth_map": False, "sets_scale": False,
}  # fmt: skip
NOTHING_DECIDED = Decisions({})


def document_of(now: Now, levels: int, is_saved: bool, depth: DepthMap | None = None) -> dict[str, object]:
    """The answer to GET /api/state; `levels` of the photo's tiles, `depth` a map on its pixels."""
    camera = now.found.camera
    scene = None if now.model is None else now.model.scene
    groups = groups_of(now)
    labelled = sum(label is not None for label in now.lines.annotations.label)
    return {
        "version": now.version,
        "photo": {
            "name": now.photo.name, "width": camera.width, "height": camera.height, "tile": TILE, "levels": levels,
        },
        "camera": None if now.found.certainty is None else summary(camera, now.found.certainty),
        "K": camera.matrix.tolist(),
        "R_cam_from_world": now.found.frame.rotation.tolist(),
        "frames": 1 + len(now.found.frame.turns),
        "metres_per_unit": None if scene is None else scene.metres_per_unit,
        "lines": _lines(now),
        "crossings": _crossings(now),
        "planes": [] if now.model is None else _planes(now, now.model),
        "bodies": list_bodies(now),
        "facts": facts_of_page(now),
        "moved": moved_by_last(now),
        "areas": told_faces(now),
        "groups": [_group(group) for group in groups],
        "notes": list(notes_of(now, groups)),
        "details": list(now.found.notes if scene is None else scene.notes),
        "depth_map": None if depth is None else document_of_layers(depth, now),
        "cells": document_of_cells(now),
        "solve": solve_of(now),
        "undo": len(now.corrections.edits),
        "redo": len(now.corrections.undone),
        "contradiction": (
            None
            if now.contradiction is None
            else {
                "lines": list(now.contradiction.lines),
                "crossings": list(now.contradiction.crossings),
                "text": now.contradiction.text,
                "facts": [each["edit"] for each in facts_of_page(now) if each["contradicted"]],
            }
        ),
        "labelling": {"done": labelled, "total": len(now.lines.crossings), "order": now.order},
        "saved": is_saved,
        "formats": formats(),
    }  # fmt: skip


def solve_of(now: Now) -> dict[str, object]:
    """How the solve stands: the one that runs, else the last one."""
    known: dict[str, object] = {
        "objective": None, "bound": None, "gap": None, "seconds": None, "status": None,
        "stage": now.stage if now.is_running else "",
    }  # fmt: skip
    if now.progress is not None and now.is_running:
        at = now.progress
        known |= {"objective": at.objective, "bound": _finite(at.bound), "gap": _finite(at.gap), "seconds": at.seconds}
    elif now.model is not None and not now.is_running:
        told = now.model.scene.solve
        known |= {
            "objective": told.objective,
            "bound": _finite(told.bound),
            "gap": _finite(told.gap),
            "seconds": now.model.seconds,
            "status": told.status,
        }
    return {
        "state": "running" if now.is_running else "idle",
        "solved_version": None if now.model is None else now.model.version,
        "fresh": now.is_fresh,
        "error": now.error or None,
        **known,
    }


def formats() -> list[dict[str, str]]:
    """What can be exported."""
    scene = {"name": SCENE_FILE[1:], "label": "the scene file: everything that was found out"}
    return [scene, *({"name": suffix[1:], "label": row.phrase} for suffix, row in FORMATS.items())]


def _lines(now: Now) -> list[dict[str, object]]:
    graph, corrected = now.lines.graph, now.lines.corrected
    origin = dict(zip(corrected.ids.tolist(), corrected.origin, strict=True))
    in_space = {} if now.model is None else _in_space(now.model.scene)
    bodies = None if now.model is None else now.model.bodies
    return [
        {
            "id": number,
            "axis": axis_name(axis),
            "segment": ends.tolist(),
            **_moved(in_space.get((axis, ends.tobytes()), NOT_IN_SPACE), bodies, number),
            "origin": origin[number],
            "metres": corrected.lengths.get(number),
        }
        for number, axis, ends in zip(now.lines.ids, graph.axis.tolist(), graph.segments.ends, strict=True)
    ]


def _moved(line: dict[str, object], bodies: ShownBodies | None, number: int) -> dict[str, object]:
    """A line with its body, where that stands now: it moves along its rays, so it looks the same in the photo."""
    body = -1 if bodies is None else bodies.body_of(number)
    if bodies is None or line["ends"] is None:
        return {**line, "body": body}
    return {**line, "body": body, "ends": (bodies.factor(body) * np.array(line["ends"])).tolist()}


@lru_cache(maxsize=2)
def _in_space(scene: Scene) -> dict[tuple[int, bytes], dict[str, object]]:
    """What a scene says about each line, by axis and segment."""
    lines = scene.lines
    guess, sets_scale = is_guess(scene), measurable(scene)
    return {
        look: {
            "ends": lines.ends[row].tolist(),
            "boundary": bool(lines.is_boundary[row]),
            "component": int(lines.component[row]),
            "confidence": str(lines.confidence[row]),
            "probability": float(lines.probability[row]) if len(lines.probability) else None,
            "guess": bool(guess[row]),
            "by_depth_map": bool(lines.by_depth_map[row]),
            "sets_scale": bool(sets_scale[row]),
        }
        for look, row in scene.lines.row_by_look.items()
    }


def _group(group: Group) -> dict[str, object]:
    return {
        "component": group.component,
        "name": group.name,
        "named": group.is_named,
        "line": group.line,
        "lines": group.lines,
        "share": group.share,
        "guess": group.guess,
    }


def _crossings(now: Now) -> list[dict[str, object]]:
    lines, decisions = now.lines, NOTHING_DECIDED if now.model is None else now.model.decisions
    return _crossings_of(lines.graph, lines.annotations, lines.ids, lines.crossings, decisions)


@lru_cache(maxsize=2)
def _crossings_of(
    graph: LineGraph, annotations: Annotations, ids: tuple[int, ...], crossings: tuple[int, ...], decisions: Decisions
) -> list[dict[str, object]]:
    """The crossings of a graph: the very list of before while what is known of them stays, for there are thousands."""
    decided, changed, far = decisions.decided, decisions.changed, decisions.far
    rows = zip(
        crossings, graph.edges.tolist(), graph.kind.tolist(), graph.crossing.tolist(), annotations.label, strict=True
    )
    return [
        {
            "id": crossing,
            "lines": [ids[i], ids[j]],
            "kind": kind,
            "pixel": pixel,
            "real": crossing in decided and decided[crossing].real,
            "reason": decided[crossing].reason if crossing in decided else None,
            "label": label,
            "changed": crossing in changed,
            "far": crossing in far,
        }
        for crossing, (i, j), kind, pixel, label in rows
    ]


def _planes(now: Now, model: Model) -> list[dict[str, object]]:
    """The planes as in the scene file, with the ids of the page's lines and triangles for each face."""
    scene = model.scene
    by_look = {
        (axis, ends.tobytes()): number
        for number, axis, ends in zip(
            now.lines.ids, now.lines.graph.axis.tolist(), now.lines.graph.segments.ends, strict=True
        )
    }
    numbers: dict[int, list[int]] = {int(line): [] for line in scene.lines.id}
    for look, row in scene.lines.row_by_look.items():
        if look in by_look:
            numbers[int(scene.lines.id[row])].append(by_look[look])
    guesses = set(scene.lines.id[is_guess(scene)].tolist())
    triangles, facades, told = triangles_of(scene), facades_in(scene), _probabilities(scene)
    components, found = scene.components_of_planes, []
    face_of = {face.id: face for _, face in scene.faces}
    for plane in scene.planes:
        lines = [number for line in plane.lines for number in numbers[line]]
        body = _body_of(plane, lines, model.bodies)
        factor = 1.0 if model.bodies is None else model.bodies.factor(body)
        guess = guesses.issuperset(plane.lines or numbers)
        faces = [_face(triangles[face.id], factor) for face in plane.faces if face.id in triangles]
        found.append({
            "id": plane.id,
            "axis": axis_name(plane.axis),
            "offset": factor * plane.offset,
            "normal": plane.normal(scene.turns).tolist(),
            "component": components[plane.id],
            "is_facade": plane.id in facades,
            "probability": told[plane.id],
            "lines": lines,
            "body": body,
            "faces": [{**face, "guess": guess, "body": body, **_kind(face_of, face["id"])} for face in faces],
        })  # fmt: skip
    return found


def _kind(faces: dict[int, Face], number: object) -> dict[str, object]:
    """What a face is of."""
    face = faces[int(str(number))]
    return {"kind": face.kind, "opening": face.opening}


def _body_of(plane: Plane, lines: list[int], bodies: ShownBodies | None) -> int:
    """The body that most lines of a plane are of, that of the ground where it is that; -1 where nothing tells."""
    if bodies is None:
        return -1
    if plane.shows_ground:
        return bodies.count
    own = [body for line in lines if (body := bodies.body_of(line)) >= 0]
    return max(sorted(set(own)), key=own.count, default=-1)


def _face(face: dict[str, object], factor: float) -> dict[str, object]:
    """A face so many times as far away."""
    if factor == 1.0:
        return face
    outline, holes = np.array(face["outline"]), face["holes"]
    assert isinstance(holes, list)
    return {
        **face,
        "outline": (factor * outline).tolist(),
        "holes": [(factor * np.array(hole)).tolist() for hole in holes],
    }


def _probabilities(scene: Scene) -> dict[int, float | None]:
    """How sure each plane is, by its id: the median of its lines; None where it has none or nothing is told."""
    lines = scene.lines
    if not len(lines.probability):
        return dict.fromkeys((plane.id for plane in scene.planes), None)
    of_line = dict(zip(lines.id.tolist(), np.asarray(lines.probability).tolist(), strict=True))
    return {
        plane.id: float(np.median([of_line[line] for line in plane.lines])) if plane.lines else None
        for plane in scene.planes
    }


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None
