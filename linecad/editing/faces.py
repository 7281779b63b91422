"""Faces as the page draws and names them: in triangles, and told by where the photo shows them."""

from functools import lru_cache
from typing import Any

import numpy as np

from exporters.drawings.facades import facades_of
from exporters.faces import FlatFace
from exporters.model import Model, build_model
from exporters.triangulation import triangulate
from linecad.corrections.edits import FaceAnchor, Point
from linecad.errors import CorrectionError, OutputError
from linecad.geometry import project
from linecad.model.scale import seen_plane
from linecad.scene import Face, Plane, Scene

NEAREST = 1e-3  # camera depth, in units of the scene; corners nearer than that have no place in the photo
NEAR_CORNER = (2 / 3, 1 / 6, 1 / 6)  # weights of a triangle's corners, of places to try beside its middle


def face_anchor(scene: Scene, pixel: Point, number: int) -> FaceAnchor:
    """The plane of a face (id), by `pixel` where the photo shows it there, else by another place of its faces.

    CorrectionError where there is no such face, or other faces with the same normal hide all of them in the photo.
    """
    found = next((plane for plane, face in scene.faces if face.id == number), None)
    if found is None:
        raise CorrectionError(f"there is no face {number} any more; reload the page")
    for place in [pixel, *_places(scene, found)]:
        seen = seen_plane(scene, place, found.axis)
        if seen is not None and seen.id == found.id:
            return FaceAnchor(place, found.axis)
    raise CorrectionError("the photo shows nothing of the face of this point; choose a point on what it shows")


def _places(scene: Scene, plane: Plane) -> list[Point]:
    """Places in the photo, px, that its faces may be seen at: those of the largest triangles in space first."""
    drawn, found = triangles_of(scene), []
    weights = np.array([(1 / 3, 1 / 3, 1 / 3), *(np.roll(NEAR_CORNER, turn) for turn in range(3))])
    for face in plane.faces:
        if face.id not in drawn:
            continue
        rings = [drawn[face.id]["outline"], *drawn[face.id]["holes"]]
        for corners in np.concatenate(rings)[drawn[face.id]["triangles"]]:
            if ((corners @ scene.rotation.T)[:, 2] > NEAREST).all():
                area = float(np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0])))
                found.append((area, project(weights @ corners, scene.camera.matrix, scene.rotation)))
    found.sort(key=lambda each: -each[0])
    size = np.array([scene.camera.width, scene.camera.height])
    pixels = [pixel for _, places in found for pixel in places if ((pixel >= 0) & (pixel < size)).all()]
    return [(float(u), float(v)) for u, v in pixels]


@lru_cache(maxsize=2)
def _model_of(scene: Scene) -> Model:
    return build_model(scene)


@lru_cache(maxsize=2)
def facades_in(scene: Scene) -> frozenset[int]:
    """The ids of the planes that an elevation can be drawn of."""
    return frozenset(facade.plane for facade in facades_of(_model_of(scene)))


@lru_cache(maxsize=2)
def triangles_of(scene: Scene) -> dict[int, dict[str, Any]]:
    """Of each face by its id: rings and triangles, indices into the points of all rings in their order."""
    flat = {face.id: face for face in _model_of(scene).faces}
    found: dict[int, dict[str, Any]] = {}
    for _, face in scene.faces:
        try:
            indices = triangulate(flat[face.id])
        except OutputError:  # a face that cannot be triangulated cannot be drawn; exports say what is wrong with it
            continue
        outline, *holes = _turned_rings(face, flat[face.id])
        found[face.id] = {
            "id": face.id,
            "kind": face.kind,
            "outline": outline,
            "holes": holes,
            "triangles": indices.tolist(),
        }
    return found


def _turned_rings(face: Face, flat: FlatFace) -> list[list[list[float]]]:
    """The rings of a face in the direction that its triangles count them in."""
    return [
        (ring if _same_direction(ring, turned) else ring[::-1]).tolist()
        for ring, turned in zip((face.outline, *face.holes), flat.rings, strict=True)
    ]


def _same_direction(ring: np.ndarray, turned: np.ndarray) -> bool:
    scale = np.linalg.norm(turned[0]) / max(np.linalg.norm(ring[0]), np.finfo(float).tiny)
    return bool(np.abs(ring * scale - turned).max() <= np.abs(ring[::-1] * scale - turned).max())
