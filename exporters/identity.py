"""What tells the things of one scene from those of all others, for formats whose things have ids for all the world."""

import hashlib
import uuid

from exporters.model import photo_name
from linecad.scene import Scene


def identity_of(scene: Scene) -> uuid.UUID:
    """The space of names of a scene, in which `uuid.uuid5` gives the id of each thing by a key of its own.

    It follows from what the scene holds but for its scale, which may be told later: the ids stay the same then.
    """
    digest = hashlib.sha256(repr((photo_name(scene), scene.openings, scene.turns)).encode())
    for numbers in (scene.camera.matrix, scene.rotation, scene.lines.id, scene.lines.ends):
        digest.update(numbers.tobytes())
    for plane, face in scene.faces:
        digest.update(repr((plane.id, face.id, face.kind, face.opening)).encode())
        for ring in (face.outline, *face.holes):
            digest.update(ring.tobytes())
    return uuid.UUID(bytes=digest.digest()[:16])
