"""The faces of a scene laid over its photo: tinted by axis, outlined, the stronger the surer their depth is."""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from exporters.bands import BANDS, bands_of
from exporters.colours import RGB, line_colour
from exporters.picture.canvas import Canvas
from linecad.arrays import Float
from linecad.scene import CONFIDENCES, Lines, Plane, Scene

# How sure a depth is, in the words of the scene: bands where it tells probabilities, else confidences.
OPACITY = {"proven": 0.30, "supported": 0.20, "weak": 0.09, "sure": 0.30, "likely": 0.20, "guess": 0.09}
_OUTLINE_WIDTH = 2  # px
_DASHES = {"weak": (12.0, 9.0), "likely": (36.0, 12.0), "guess": (9.0, 12.0)}  # px of a dash and a gap; else none
_NEAREST_SHARE = 0.02  # of the middle depth: parts of faces nearer to the camera are cut off


def words_of(lines: Lines) -> tuple[list[str], tuple[str, ...]]:
    """How sure the depth of each line is, in a word; and all such words, the surest first."""
    bands = bands_of(lines)
    return (lines.confidence.tolist(), CONFIDENCES) if bands is None else (bands.tolist(), BANDS)


def word_of(plane: Plane, word: dict[int, str], words: Sequence[str]) -> str:
    """The word that most lines of a plane have, given that of each line by id; the less sure one of two.

    `words` are all there are, the surest first. A ground that no line shows is where all of them put it.
    """
    counts = Counter(word[number] for number in plane.lines or word)
    return max(reversed(words), key=lambda each: counts[each])


def draw_faces(panel: Canvas, scene: Scene, scale: Float) -> None:
    """Draw the faces where the photo shows them; `scale` (2,) is px of the panel for each px of the photo."""
    depth = scene.lines.ends.reshape(-1, 3) @ scene.rotation[2]
    nearest = _NEAREST_SHARE * float(np.median(depth[depth > 0])) if (depth > 0).any() else _NEAREST_SHARE
    found, words = words_of(scene.lines)
    word_by_id = dict(zip(scene.lines.id.tolist(), found, strict=True))
    groups: dict[tuple[int, str], list[list[Float]]] = {}
    for plane, face in scene.faces:
        rings = [_before(ring @ scene.rotation.T, nearest) for ring in (face.outline, *face.holes)]
        rays = [ring @ scene.camera.matrix.T for ring in rings if len(ring)]
        pixels = [(ray[:, :2] / ray[:, 2:] + 0.5) * scale - 0.5 for ray in rays]
        if pixels:
            groups.setdefault((plane.axis, word_of(plane, word_by_id, words)), []).append(pixels)
    for (axis, word), polygons in sorted(groups.items()):
        colour = line_colour(axis, True)
        panel.tint(polygons, colour, OPACITY[word])
        for ring in (ring for rings in polygons for ring in rings):
            for start, end in zip(ring.tolist(), np.roll(ring, -1, axis=0).tolist(), strict=True):
                draw_line(panel, (start, end), word, colour, _OUTLINE_WIDTH)


def draw_line(panel: Canvas, ends: Sequence[list[float]], word: str, colour: RGB, width: int) -> None:
    """A line that is drawn through or dashed, by the word for how sure it is."""
    start, end = ends
    if word in _DASHES:
        draw_dashed(panel, start, end, _DASHES[word], colour, width)
    else:
        panel.line(start, end, colour, width)


def draw_dashed(
    panel: Canvas, start: list[float], end: list[float], dash: tuple[float, float], colour: RGB, width: int
) -> None:
    """A line of dashes and gaps, px each; the part of it outside the panel is not drawn."""
    long, gap = dash
    first, along = np.array(start), np.subtract(end, start)
    length = float(np.linalg.norm(along))
    low, high = _inside(first, along, np.array([panel.width, panel.height], float))
    for at in np.arange(low * length, high * length, long + gap).tolist():
        stop = min(at + long, high * length)
        panel.line((first + at / length * along).tolist(), (first + stop / length * along).tolist(), colour, width)


def _inside(start: Float, along: Float, size: Float) -> tuple[float, float]:
    """From where to where, as shares of its length, a line runs through a panel (Liang and Barsky); 0, 0 if nowhere."""
    low, high = 0.0, 1.0
    for origin, step, limit in zip(start.tolist(), along.tolist(), size.tolist(), strict=True):
        if step == 0:
            if not 0 <= origin <= limit:
                return 0.0, 0.0
            continue
        enter, leave = sorted((-origin / step, (limit - origin) / step))
        low, high = max(low, enter), min(high, leave)
    return (low, high) if low < high else (0.0, 0.0)


def _before(ring: Float, nearest: float) -> Float:
    """The part of a ring (V, 3) in the camera frame that lies at least `nearest` deep (Sutherland and Hodgman)."""
    kept: list[Float] = []
    for start, end in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        if start[2] >= nearest:
            kept.append(start)
        if (start[2] >= nearest) != (end[2] >= nearest):
            kept.append(start + (nearest - start[2]) / (end[2] - start[2]) * (end - start))
    return np.array(kept).reshape(-1, 3)
