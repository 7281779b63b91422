"""The camera in an fSpy project: https://github.com/stuffmatic/fSpy/blob/develop/project_file_format.md

Image plane coordinates have their origin in the middle of the photo, y up, and half of its longer side as unit.
"""

import math
import struct
from pathlib import Path

import numpy as np

from linecad.arrays import Float
from linecad.errors import CameraError
from linecad.io import strict_json as strictjson
from linecad.io.strict_json import JsonError

SUFFIX = ".fspy"
_MAGIC, _VERSION = b"fspy", 1
_HEADER = struct.Struct("<4sIII")  # magic, version, bytes of the state, bytes of the photo
_STATE_LIMIT = 10_000_000  # bytes; a state takes some thousands
_SMALLEST_ANGLE = 1e-6  # rad; far smaller ones have a tangent of zero
_LARGEST_NUMBER = 1e6  # px, and in image plane coordinates


def read_fspy(path: Path) -> tuple[int, int, Float]:
    """Width and height in px and K (3, 3) of the photo that a project was made with.

    Raises CameraError when the file cannot be read, is no project, is cut short, or holds no camera.
    """
    try:
        camera = strictjson.parse(_read_state(path))["cameraParameters"]
        if camera.value is None:
            raise CameraError(f"{path} holds no camera, for its vanishing points give none; correct them in fSpy")
        width, height = (camera[key].integer(1, int(_LARGEST_NUMBER)) for key in ("imageWidth", "imageHeight"))
        half = max(width, height) / 2
        point = camera["principalPoint"]
        x, y = (point[key].number(_LARGEST_NUMBER) for key in "xy")
        relative = camera.get("relativeFocalLength")
        if relative is not None:
            focal = relative.number(_LARGEST_NUMBER) * half
        else:  # programs that imitate fSpy may write the angle alone, of the longer side
            angle = camera["horizontalFieldOfView"]
            if not _SMALLEST_ANGLE < angle.number() < math.pi:
                raise angle.wrong("an angle between 0 and pi")
            focal = half / math.tan(angle.number() / 2)
    except (JsonError, UnicodeDecodeError) as error:
        reason = "its state is not text in UTF-8" if isinstance(error, UnicodeDecodeError) else error
        raise CameraError(f"{path}: {reason}; give a project that fSpy saved") from error
    matrix = np.array([[focal, 0, width / 2 + x * half - 0.5], [0, focal, height / 2 - y * half - 0.5], [0, 0, 1]])
    return width, height, matrix


def _read_state(path: Path) -> str:
    """The JSON text of a project."""
    try:
        if not path.is_file():
            raise CameraError(f"{path} is {'a folder' if path.is_dir() else 'missing'}; give a project that fSpy saved")
        with path.open("rb") as file:
            header = file.read(_HEADER.size)
            if len(header) < _HEADER.size or header[:4] != _MAGIC:
                raise CameraError(f"{path} is no fSpy project; give one that fSpy saved, or a camera file as JSON")
            _, version, state, image = _HEADER.unpack(header)
            if version != _VERSION:
                raise CameraError(f"{path} is an fSpy project of version {version}, but only 1 can be read here")
            if state > _STATE_LIMIT:
                raise CameraError(f"{path} says that its state has {state / 1e6:.0f} MB, far too much; save it anew")
            if path.stat().st_size < _HEADER.size + state + image:
                raise CameraError(f"{path} is cut short; save it anew")
            return file.read(state).decode()
    except OSError as error:
        raise CameraError(f"{path} cannot be read ({error.strerror}); check its permissions") from error
