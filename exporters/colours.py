"""The colours of lines and faces, chosen in sRGB, with the conversion for formats that want linear light."""

import numpy as np

from linecad.scene import FaceKind

RGB = tuple[float, float, float]

FACE: RGB = (0.80, 0.79, 0.74)  # sRGB, 0 to 1: a light stone grey against which all line colours stand out
_PART: dict[FaceKind, RGB] = {"window": (0.49, 0.62, 0.72), "door": (0.56, 0.41, 0.29), "reveal": (0.69, 0.66, 0.60)}
_AXIS: tuple[RGB, RGB, RGB] = ((0.87, 0.16, 0.16), (0.10, 0.62, 0.22), (0.15, 0.36, 0.92))
# Of the level axes of further frames, two pairs in turn: as warm and as cold as x and y, but no shade of them.
_FURTHER: tuple[RGB, ...] = ((0.93, 0.55, 0.10), (0.05, 0.60, 0.65), (0.76, 0.20, 0.70), (0.55, 0.60, 0.10))
_PALE = 0.5  # share of white in the colour of a line that is no boundary


def line_colour(axis: int, is_boundary: bool) -> RGB:
    """sRGB, 0 to 1: x red, y green, z blue, further frames others; paler where the line is no boundary."""
    white = 0.0 if is_boundary else _PALE
    full = _AXIS[axis] if axis < len(_AXIS) else _FURTHER[(axis - len(_AXIS)) % len(_FURTHER)]
    red, green, blue = (round(white + (1.0 - white) * value, 4) for value in full)
    return (red, green, blue)


def face_colour(kind: FaceKind) -> RGB:
    """sRGB, 0 to 1, of a face without a texture: panes and reveals differ from the walls that they are in."""
    return _PART.get(kind, FACE)


def face_colour_name(kind: FaceKind) -> str:
    """What the colour of such faces is called among materials."""
    return kind if kind in _PART else "face"


def linear(colour: RGB) -> RGB:
    """Linear light from sRGB (IEC 61966-2-1), as glTF factors and USD colours are defined."""
    srgb = np.array(colour)
    red, green, blue = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4).tolist()
    return (red, green, blue)
