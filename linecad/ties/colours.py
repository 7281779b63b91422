"""Colours: walls of one house have one colour, whatever light falls on them."""

import cv2
import numpy as np
from scipy.ndimage import gaussian_filter

from linecad.arrays import Float
from linecad.ties.setting import Setting

BLUR = 1.5  # px, against the grain
BINS = 24  # along each of the two axes of colour
SPREAD = 0.8  # bins
BESIDE = (14.0, 26.0)  # px at the reference width to both sides of a line, where its wall is looked at
ALONG = np.linspace(0.1, 0.9, 5)
TYPICAL = 0.87  # likeness of two walls of one photo: what is assumed where there is nothing to look at


def find_colours(setting: Setting) -> list[Float] | None:
    """How often each colour (BINS, BINS; a and b of CIE Lab) stands beside the lines of each body; sums are 1.

    None without pixels.
    """
    if setting.sight.pixels is None:
        return None
    blurred = cv2.GaussianBlur(setting.sight.pixels, (0, 0), BLUR)
    height, width = blurred.shape[:2]
    ends = setting.graph.segments.ends
    along = ends[:, 1] - ends[:, 0]
    along = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    steps = np.array([side * far for side in (-1, 1) for far in BESIDE]) / setting.scale
    found = []
    for lines in setting.lines:
        middle = ends[lines, None, 0] + ALONG[None, :, None] * (ends[lines, 1] - ends[lines, 0])[:, None]
        places = (middle[:, :, None] + steps[None, None, :, None] * across[lines, None, None]).reshape(-1, 2)
        column, row = np.clip(np.rint(places).astype(np.int64), 0, [width - 1, height - 1]).T
        # Of the photo few pixels are looked at, so only those are converted.
        seen = cv2.cvtColor(blurred[row, column][:, None], cv2.COLOR_RGB2LAB)[:, 0, 1:].astype(np.float64)
        counts = np.histogram2d(seen[:, 0], seen[:, 1], bins=BINS, range=[(0, 256)] * 2)[0]
        smooth = gaussian_filter(counts, SPREAD)
        found.append(smooth / smooth.sum())
    return found


def likeness(colours: list[Float] | None, first: int, second: int) -> float:
    """The part of their colours that two bodies have in common, 0 to 1; TYPICAL where nothing is known."""
    return TYPICAL if colours is None else float(np.minimum(colours[first], colours[second]).sum())
