"""Colours: walls of one house have one colour, whatever light falls on them."""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from linecad.arrays import Float
from linecad.geometry import unit_normals
from linecad.ties.setting import Setting

BLUR = 1.5  # px, against the grain
BINS = 24  # along each of the two axes of colour
SPREAD = 0.8  # bins
BESIDE = (14.0, 26.0)  # px at the reference width to both sides of a line, where its wall is looked at
ALONG = np.linspace(0.1, 0.9, 5)
TYPICAL = 0.87  # likeness of two walls of one photo: what is assumed where there is nothing to look at
SHADES = 16  # along each of the three axes of shade
MOST_CHROMA = 32  # of a and b, in steps of 8 bits

Seen = NDArray[np.uint8]


def find_colours(setting: Setting, beside: Seen | None) -> list[Float] | None:
    """How often each colour (BINS, BINS; a and b of CIE Lab) stands beside the lines of each body; sums are 1.

    By what is seen beside each line (`seen_beside`); None where nothing is.
    """
    if beside is None:
        return None
    found = []
    for lines in setting.lines:
        seen = beside[lines].reshape(-1, 3)[:, 1:].astype(np.float64)
        counts = np.histogram2d(seen[:, 0], seen[:, 1], bins=BINS, range=[(0, 256)] * 2)[0]
        smooth = gaussian_filter(counts, SPREAD)
        found.append(smooth / smooth.sum())
    return found


def shades(beside: Seen) -> Float:
    """How often each shade (SHADES, SHADES, SHADES; CIE Lab) is among what is seen (L, P, 3) beside lines; sum 1.

    Unlike a colour it has its lightness: parts of one wall stand in one light.
    """
    low, high = 128 - MOST_CHROMA, 128 + MOST_CHROMA
    ranges = [(0, 256), (low, high), (low, high)]
    seen = np.clip(beside.reshape(-1, 3), [0, low, low], [255, high, high])
    smooth: Float = gaussian_filter(np.histogramdd(seen, bins=SHADES, range=ranges)[0], SPREAD)
    shares: Float = smooth / smooth.sum()
    return shares


def seen_beside(setting: Setting) -> Seen | None:
    """The photo beside each line (N, P, 3), CIE Lab in 8 bits. None without pixels."""
    if setting.sight.pixels is None:
        return None
    blurred = cv2.GaussianBlur(setting.sight.pixels, (0, 0), BLUR)
    height, width = blurred.shape[:2]
    ends = setting.graph.segments.ends
    whole = ends[:, 1] - ends[:, 0]
    across = unit_normals(whole)
    steps = np.array([side * far for side in (-1, 1) for far in BESIDE]) / setting.scale
    middle = ends[:, None, 0] + ALONG[None, :, None] * whole[:, None]
    places = middle[:, :, None] + steps[None, None, :, None] * across[:, None, None]
    column, row = np.clip(np.rint(places.reshape(-1, 2)).astype(np.int64), 0, [width - 1, height - 1]).T
    # Of the photo few pixels are looked at, so only those are converted.
    lab = cv2.cvtColor(blurred[row, column][:, None], cv2.COLOR_RGB2LAB)
    return np.asarray(lab.reshape(len(ends), -1, 3), np.uint8)


def likeness(colours: list[Float] | None, first: int, second: int) -> float:
    """The part of their colours that two bodies have in common, 0 to 1; TYPICAL where nothing is known."""
    return TYPICAL if colours is None else in_common(colours[first], colours[second])


def in_common(one: Float, other: Float) -> float:
    """The part that two distributions have in common, 0 to 1."""
    return float(np.minimum(one, other).sum())
