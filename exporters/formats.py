"""The formats that a scene can be written in, and the one function that writes them all.

To add a format, write one module with `write(scene, path)` and give it a row in FORMATS.
"""

import importlib
import threading
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linecad.errors import OutputError
from linecad.files import check_output, write_atomically
from linecad.scene import Camera, Scene

SCENE_FILE = ".json"  # written by linecad.scenefile; named here only to tell the user


# ezdxf and OCCT have settings for the whole process, which a second thread would change under the first.
_ONE_AT_A_TIME = threading.Lock()


class Format(NamedTuple):
    """A row of the table of formats."""

    module: str  # imported only when the format is written: its libraries take up to seconds to load
    phrase: str  # what the file holds, for people
    unit: str  # of the lengths in the file
    shows_photo: bool = False  # its `write` also takes the photo


FORMATS: dict[str, Format] = {
    ".dxf": Format("exporters.dxf", "lines on layers, faces and their outlines", "metres"),
    ".step": Format("exporters.step", "lines and faces as named and coloured parts", "millimetres"),
    ".glb": Format("exporters.gltf", "lines, faces and the camera for viewers and Blender", "metres"),
    ".usda": Format("exporters.usd", "a USD stage as text: lines, faces, camera", "metres"),
    ".usdc": Format("exporters.usd", "a USD stage as a compact file: lines, faces, camera", "metres"),
    ".usdz": Format("exporters.usd", "a USD stage as a package: lines, faces, camera", "metres"),
    ".obj": Format("exporters.mesh", "faces as triangles, and lines", "metres"),
    ".ply": Format("exporters.mesh", "faces as triangles", "metres"),
    ".stl": Format("exporters.mesh", "faces as triangles", "metres"),
    ".png": Format("exporters.picture", "the photo with its lines, and three views of them in space", "pixels", True),
}


def suffixes() -> tuple[str, ...]:
    """The suffixes of all formats, in lower case."""
    return tuple(FORMATS)


def find_format(path: Path) -> Format:
    """The format that the suffix of `path` chooses, in upper or lower case; OutputError for an unknown one."""
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        found = f"unknown suffix {suffix}" if suffix else "no suffix"
        known = f"{', '.join(FORMATS)}, or {SCENE_FILE} for the scene file"
        raise OutputError(f"{path.name}: {found}; use {known}")
    return FORMATS[suffix]


def export(scene: Scene, path: Path, photo: NDArray[np.uint8] | None = None) -> None:
    """Write a scene in the format that the suffix of `path` chooses, whole or not at all.

    `photo` is RGB, (H, W, 3), of exactly the size of the scene's camera; formats that show the photo do without it
    where it is None. Raises ValueError for a photo of another kind, and OutputError for an unknown suffix, a place
    that cannot be written, a full disk, or a scene that holds nothing for this format.
    """
    chosen = find_format(path)
    _check_photo(photo, scene.camera)
    if not len(scene.lines) and not scene.faces:
        raise OutputError(f"{path.name}: the scene holds neither lines nor faces; there is nothing to write")
    check_output(path)
    module = importlib.import_module(chosen.module)

    def write(temporary: Path) -> None:
        with _ONE_AT_A_TIME:
            if chosen.shows_photo:
                module.write(scene, temporary, photo)
            else:
                module.write(scene, temporary)

    write_atomically(path, write)


def _check_photo(photo: NDArray[np.uint8] | None, camera: Camera) -> None:
    wanted = (camera.height, camera.width, 3)
    if photo is not None and (photo.shape != wanted or photo.dtype != np.uint8):
        raise ValueError(f"photo is {photo.dtype} of shape {photo.shape}, expected uint8 of shape {wanted}")
