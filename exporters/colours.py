"""The colours of lines and faces, chosen in sRGB, with the conversion for formats that want linear light."""

import numpy as np

RGB = tuple[float, float, float]

FACE: RGB = (0.80, 0.79, 0.74)  # sRGB, 0 to 1: a light stone grey against which all line colours stand out
_AXIS: tuple[RGB, RGB, RGB] = ((0.87, 0.16, 0.16), (0.10, 0.62, 0.22), (0.15, 0.36, 0.92))
_PALE = 0.5  # share of white in the colour of a line that is no boundary


def line_colour(axis: int, is_boundary: bool) -> RGB:
    """sRGB, 0 to 1: x red, y green, z blue; paler where the line is no boundary."""
    white = 0.0 if is_boundary else _PALE
    red, green, blue = (round(white + (1.0 - white) * value, 4) for value in _AXIS[axis])
    return (red, green, blue)


def linear(colour: RGB) -> RGB:
    """Linear light from sRGB (IEC 61966-2-1), as glTF factors and USD colours are defined."""
    srgb = np.array(colour)
    red, green, blue = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4).tolist()
    return (red, green, blue)
