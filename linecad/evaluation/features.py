"""Colours about crossings: what a photo says about a crossing beyond the geometry of its two segments."""

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float
from linecad.geometry import REFERENCE_WIDTH
from linecad.line_graph import LineGraph

ASIDE = 10.0  # px at the reference width from both lines to the middle of a sampled patch
ASIDE_FLOOR = 3.0  # px
PATCH = 1  # px to each side of that middle
COLOUR_FEATURES = ("contrast across the one", "contrast across the other", "contrast across the diagonal")


def colour_features(pixels: NDArray[np.uint8], graph: LineGraph) -> Float:
    """Contrasts (E, 3), 0 to 1, between the four patches that the two lines of a crossing part.

    Patches are named by the sides of the two lines on which they lie. Across a line: the mean difference of the two
    pairs of patches that this line parts, the smaller of the two lines first. Across the diagonal: the smaller
    difference of the two pairs that both lines part. Where paint ends at an edge, three patches agree; where a near
    wall hides a far one, the two on the near side do. Collinear edges get zeros.
    """
    aside = max(ASIDE * pixels.shape[1] / REFERENCE_WIDTH, ASIDE_FLOOR)
    ends = graph.segments.ends
    along = (ends[:, 1] - ends[:, 0]) / graph.segments.length[:, None]
    one, other = along[graph.edges[:, 0]], along[graph.edges[:, 1]]
    turn = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    crossing = (graph.kind != "collinear") & (np.abs(turn) > 1e-6)
    # Moving along the one line by t moves away from the other by t |turn|.
    step = (aside / np.where(crossing, np.maximum(np.abs(turn), 0.2), 1.0))[:, None]
    patch = {(i, j): _colours(pixels, graph.crossing + step * (i * one + j * other)) for i in (-1, 1) for j in (-1, 1)}

    def apart(first: tuple[int, int], second: tuple[int, int]) -> Float:
        difference: Float = np.abs(patch[first] - patch[second]).mean(axis=1)
        return difference

    across_one = (apart((-1, -1), (-1, 1)) + apart((1, -1), (1, 1))) / 2
    across_other = (apart((-1, -1), (1, -1)) + apart((-1, 1), (1, 1))) / 2
    diagonal = np.minimum(apart((-1, -1), (1, 1)), apart((-1, 1), (1, -1)))
    found = np.column_stack([np.minimum(across_one, across_other), np.maximum(across_one, across_other), diagonal])
    return np.where(crossing[:, None], found, 0.0)


def _colours(pixels: NDArray[np.uint8], places: Float) -> Float:
    """Mean colours (N, 3), 0 to 1, of patches about places (N, 2) px, moved into the photo where they lie outside."""
    height, width = pixels.shape[:2]
    offset = np.arange(-PATCH, PATCH + 1)
    column = np.clip(np.rint(places[:, 0]).astype(np.int64)[:, None] + offset, 0, width - 1)
    row = np.clip(np.rint(places[:, 1]).astype(np.int64)[:, None] + offset, 0, height - 1)
    colours: Float = pixels[row[:, :, None], column[:, None, :]].mean(axis=(1, 2)) / 255
    return colours
