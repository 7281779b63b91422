"""PNG: a photo with its segments by axis, horizon, vanishing points and principal point: how its camera was found.

About the photo is a margin, in which vanishing points near it lie; to those farther off an arrow points.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from exporters.camera import vanishing_points
from exporters.colours import RGB, line_colour
from exporters.picture.canvas import Canvas, drawable, text_width
from linecad.arrays import Float
from linecad.line_graph import Segments
from linecad.scene import AXES, Camera, Certainty

_WIDTH = 1840  # px
_EDGE = 40  # px between the border of the picture and what is on it
_MARGIN = 150  # px about the photo
_PHOTO_HEIGHT = 1300  # px, at most
_THINNEST = 40  # px that the thinnest strip of a photo still gets
_TITLE, _TEXT, _LABEL = 42, 27, 29  # px of text
_ROW = 40  # px between rows of text

_PAPER, _INK, _QUIET = (0.965, 0.965, 0.97), (0.13, 0.13, 0.15), (0.40, 0.40, 0.43)
_GROUND = (0.90, 0.90, 0.91)  # of the margin
_OUTLIER, _HORIZON, _CASING = (0.35, 0.35, 0.37), (0.93, 0.45, 0.05), (1.0, 1.0, 1.0)
_CENTRE = (0.62, 0.05, 0.60)
_QUALITY: dict[str, RGB] = {"good": (0.05, 0.50, 0.20), "doubtful": (0.75, 0.42, 0.0), "poor": (0.78, 0.08, 0.08)}

_LINE, _OUTLIER_LINE, _CASED = 3, 2, 2  # px: widths, and how much wider a casing is
_MANY = 1500  # segments; from there on they are drawn thinner
_POINT, _ARROW, _HEAD = 13.0, 64.0, 18.0  # px: radius of a vanishing point, length of an arrow and of its head
_INSET = 34.0  # px between the tip of an arrow and the border of the margin
_INNER_ARM, _SMALLEST_ELLIPSE = 4.0, 9.0  # px, so that a point that is known well is seen


@dataclass(frozen=True, eq=False)
class CameraPicture:
    """What is drawn."""

    camera: Camera
    rotation: Float  # (3, 3) world to camera
    segments: Segments  # px; axis -1 for those of no axis
    certainty: Certainty
    horizon: Float | None  # (2, 2) px, two points on it
    places: tuple[str, ...]  # of the vanishing points of x, y, z, in words
    shares: tuple[float, ...]  # of the segment length that x, y, z and no axis explain
    title: str
    facts: tuple[str, ...]  # for people, in this order, below the photo


class _Window:
    """The margin with the photo in its middle: draws where pixels of the photo say."""

    def __init__(self, canvas: Canvas, camera: Camera, photo_width: int, photo_height: int) -> None:
        self.canvas = canvas
        self.left, self.top = (canvas.width - photo_width) // 2, (canvas.height - photo_height) // 2
        self.photo = canvas.window(self.left, self.top, photo_width, photo_height)
        self.scale = np.array([photo_width / camera.width, photo_height / camera.height])

    def shown(self, pixels: Float) -> Float:
        """Pixels (..., 2) of the photo, counted from the centre of the first, as px of the window."""
        result: Float = (pixels + 0.5) * self.scale - 0.5 + (self.left, self.top)
        return result


def write(picture: CameraPicture, path: Path, photo: NDArray[np.uint8]) -> None:
    """Write the picture to `path`; OSError where that fails. `photo` is RGB, of the size of the camera."""
    largest = _WIDTH - 2 * (_EDGE + _MARGIN)
    scale = min(largest / picture.camera.width, _PHOTO_HEIGHT / picture.camera.height)
    width, height = (max(round(size * scale), _THINNEST) for size in (picture.camera.width, picture.camera.height))
    facts = _rows(picture.facts)
    top = _EDGE + 116
    below = top + height + 2 * _MARGIN + 46
    canvas = Canvas(_WIDTH, below + _ROW * (1 + len(facts)) + 20, _PAPER)
    _draw_title(canvas, picture)
    window = _Window(
        canvas.window(_EDGE, top, _WIDTH - 2 * _EDGE, height + 2 * _MARGIN), picture.camera, width, height
    )  # fmt: skip
    window.canvas.fill(_GROUND)
    window.photo.show(photo)
    _draw_segments(window, picture.segments)
    horizon_shows = _draw_horizon(window, picture.horizon)
    _draw_centre(window, picture)
    _draw_vanishing_points(window, picture)
    _draw_legend(canvas, picture, below, horizon_shows)
    for number, row in enumerate(facts):
        canvas.text(_EDGE, below + 6 + _ROW * (number + 1), row, _TEXT, _QUIET, "lm")
    canvas.image().save(path, format="PNG")


def _draw_title(canvas: Canvas, picture: CameraPicture) -> None:
    canvas.text(_EDGE, _EDGE + 38, _shortened(drawable(picture.title), _TITLE, _WIDTH - 2 * _EDGE), _TITLE, _INK)
    quality = picture.certainty.quality
    canvas.text(_EDGE, _EDGE + 86, quality, _LABEL, _QUALITY[quality])
    left = _EDGE + text_width(quality, _LABEL)
    reason = _shortened(drawable(f": {picture.certainty.reason}"), _LABEL, _WIDTH - _EDGE - left)
    canvas.text(left, _EDGE + 86, reason, _LABEL, _INK)


def _shortened(text: str, size: int, width: float) -> str:
    """The text, cut off where it would be wider than `width` px."""
    if text_width(text, size) <= width:
        return text
    while text and text_width(f"{text} ...", size) > width:
        text = text[:-1]
    return f"{text} ..."


def _rows(facts: Sequence[str]) -> list[str]:
    """The facts in as few rows as hold them."""
    rows: list[str] = []
    for fact in map(drawable, facts):
        longer = f"{rows[-1]}   ·   {fact}" if rows else fact
        if rows and text_width(longer, _TEXT) <= _WIDTH - 2 * _EDGE:
            rows[-1] = longer
        else:
            rows.append(_shortened(fact, _TEXT, _WIDTH - 2 * _EDGE))
    return rows


def _draw_segments(window: _Window, segments: Segments) -> None:
    """Those of no axis below the others; all have a light casing that keeps them apart from the photo."""
    ends = window.shown(segments.ends) - (window.left, window.top)
    thinner = 1 if len(segments) > _MANY else 0
    for own, width in ((segments.axis < 0, _OUTLIER_LINE), (segments.axis >= 0, _LINE - thinner)):
        for start, end in ends[own].tolist():
            window.photo.line(start, end, _CASING, width + _CASED)
        for axis, (start, end) in zip(segments.axis[own].tolist(), ends[own].tolist(), strict=True):
            window.photo.line(start, end, _OUTLIER if axis < 0 else line_colour(axis, True), width)


def _draw_horizon(window: _Window, horizon: Float | None) -> bool:
    """From border to border of the margin; whether any of it shows."""
    if horizon is None:
        return False
    start, end = window.shown(horizon)
    along = (end - start) / np.linalg.norm(end - start)
    middle = start + ((window.canvas.width / 2, window.canvas.height / 2) - start) @ along * along
    reach = (window.canvas.width + window.canvas.height) * along
    before = window.canvas.pixels.copy()
    for colour, width in ((_CASING, _LINE + _CASED + 1), (_HORIZON, _LINE)):
        window.canvas.line((middle - reach).tolist(), (middle + reach).tolist(), colour, width)
    return bool((before != window.canvas.pixels).any())


def _draw_centre(window: _Window, picture: CameraPicture) -> None:
    """The principal point, with the ellipse of its standard errors where it was estimated."""
    centre = window.shown(picture.camera.matrix[:2, 2])
    errors = None if picture.certainty.center is None else np.array(picture.certainty.center) * window.scale
    _draw_principal_point(window.canvas, centre.tolist(), None if errors is None else errors.tolist())


def _draw_principal_point(canvas: Canvas, centre: list[float], errors: list[float] | None) -> None:
    # Inside of an ellipse the cross is small, so that the two do not become a blot.
    (x, y), arm, thick = centre, *((_POINT, 3) if errors is None else (_INNER_ARM, 2))
    for colour, wider in ((_CASING, 3), (_CENTRE, 0)):
        canvas.line((x - arm, y), (x + arm, y), colour, thick + wider)
        canvas.line((x, y - arm), (x, y + arm), colour, thick + wider)
    for colour, width in ((_CASING, 5), (_CENTRE, 3)):
        if errors is not None:
            canvas.ellipse(centre, [max(error, _SMALLEST_ELLIPSE) for error in errors], colour, width)


def _draw_vanishing_points(window: _Window, picture: CameraPicture) -> None:
    canvas = window.canvas
    size = np.array([canvas.width, canvas.height], float)
    horizon = None if picture.horizon is None else window.shown(picture.horizon)
    points = window.shown(vanishing_points(picture.camera, picture.rotation) - 0.5)
    centre = window.shown(picture.camera.matrix[:2, 2])
    for axis, (point, place) in enumerate(zip(points, picture.places, strict=True)):
        text, colour = f"{AXES[axis]}  {place}", line_colour(axis, True)
        if (point > _POINT).all() and (point < size - 1 - _POINT).all():
            canvas.disc(point.tolist(), _POINT + 3, _CASING)
            canvas.ring(point.tolist(), _POINT, colour, 4)
            canvas.disc(point.tolist(), 4.0, colour)
            _draw_label(canvas, point, np.array([0.0, 1.0]), text, colour)
        else:
            middle = _arrow_start(centre, None if axis == AXES.index("z") else horizon, size)
            along = (point - middle) / np.linalg.norm(point - middle)
            tip = middle + _reach(middle, along, size) * along
            _draw_arrow(canvas, tip, along, colour)
            _draw_label(canvas, tip - _ARROW / 2 * along, along, text, colour)


def _arrow_start(centre: Float, horizon: Float | None, size: Float) -> Float:
    """Where the way to a vanishing point starts: at the principal point, or on a horizon that the window shows."""
    start = centre
    if horizon is not None:
        along = (horizon[1] - horizon[0]) / np.linalg.norm(horizon[1] - horizon[0])
        foot = horizon[0] + (centre - horizon[0]) @ along * along
        if (foot > _INSET).all() and (foot < size - 1 - _INSET).all():
            start = foot
    inside: Float = np.clip(start, _INSET, np.maximum(size - 1 - _INSET, _INSET))
    return inside


def _reach(start: Float, along: Float, size: Float) -> float:
    """How far the border, less the inset, lies from a point inside of it."""
    limits = np.where(along > 0, size - 1 - _INSET, _INSET)
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.nanmin(np.where(along == 0, np.inf, (limits - start) / along)))


def _draw_arrow(canvas: Canvas, tip: Float, along: Float, colour: RGB) -> None:
    across = np.array([-along[1], along[0]])
    for width, ink in ((9, _CASING), (5, colour)):
        canvas.line((tip - _ARROW * along).tolist(), tip.tolist(), ink, width)
        for side in (-1, 1):
            canvas.line((tip - _HEAD * along + side * 0.7 * _HEAD * across).tolist(), tip.tolist(), ink, width)


def _draw_label(canvas: Canvas, at: Float, along: Float, text: str, colour: RGB) -> None:
    """A label beside a mark that runs along a direction, on a light ground inside the window."""
    width, height = text_width(text, _LABEL) + 20, _LABEL + 16.0
    steep = abs(along[1]) > abs(along[0])
    x, y = at + ((width / 2 + 26, 0.0) if steep else (0.0, -height / 2 - 22))
    if steep and x + width / 2 > canvas.width - 4:
        x = at[0] - width / 2 - 26
    x = float(np.clip(x, width / 2 + 4, max(canvas.width - width / 2 - 4, width / 2 + 4)))
    y = float(np.clip(y, height / 2 + 4, max(canvas.height - height / 2 - 4, height / 2 + 4)))
    left, top = max(round(x - width / 2), 0), max(round(y - height / 2), 0)
    ground = canvas.window(left, top, round(width), round(height))  # small: a tint costs what its picture is large
    right, bottom = ground.width - 1.0, ground.height - 1.0
    ground.tint([[np.array([[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]])]], _CASING, 0.85)
    canvas.text(x, y, text, _LABEL, colour, "mm")


def _draw_legend(canvas: Canvas, picture: CameraPicture, y: float, horizon_shows: bool) -> None:
    x = float(_EDGE)
    for axis, share in enumerate(picture.shares):
        colour = line_colour(axis, True) if axis < len(AXES) else _OUTLIER
        name = AXES[axis] if axis < len(AXES) else "no axis"
        canvas.line((x, y), (x + 44, y), colour, 5)
        x = _label(canvas, x + 56, y, f"{name} {share:.0%}")
    canvas.line((x, y), (x + 44, y), _HORIZON, 5)
    x = _label(canvas, x + 56, y, "horizon" if horizon_shows else "horizon: outside")
    canvas.ring((x + 14, y), _POINT, _INK, 4)
    canvas.disc((x + 14, y), 4.0, _INK)
    x = _label(canvas, x + 38, y, "vanishing point")
    _draw_arrow(canvas, np.array([x + 46.0, y]), np.array([1.0, 0.0]), _INK)
    x = _label(canvas, x + 58, y, "farther off")
    estimated = picture.certainty.center is not None
    _draw_principal_point(canvas, [x + 14, y], [14.0, 10.0] if estimated else None)
    _label(canvas, x + 38, y, "principal point" + (" and its error" if estimated else ""))


def _label(canvas: Canvas, x: float, y: float, text: str) -> float:
    """Write a label of the legend; where the next entry starts."""
    canvas.text(x, y, text, _TEXT, _INK, "lm")
    return x + text_width(text, _TEXT) + 34
