"""The lines in space as seen from above, from the front and from the side, each view with one scale on both axes.

Lines of the largest component have the full colour of their axis; those of smaller ones, whose scale is their own, are
paler. Where the scene tells probabilities, guesses are paler and all others have the full colour.
"""

import math
from dataclasses import dataclass

import numpy as np

from exporters.bands import GUESS, bands_of
from exporters.colours import line_colour
from exporters.model import metres_per_unit
from exporters.picture.canvas import Canvas
from linecad.arrays import Float
from linecad.scene import AXES, Lines, Scene

# name, the axis that points right, the one that points up
VIEWS = (("top", 0, 1), ("front", 0, 2), ("side", 1, 2))
_DEPTH_AXIS = 1  # points away from the camera: without it a view looks the way the camera does

_INK, _QUIET, _GRID, _PAPER = (0.13, 0.13, 0.15), (0.45, 0.45, 0.48), (0.93, 0.93, 0.94), (1.0, 1.0, 1.0)
_FACE_OPACITY = 0.12
_EDGES = np.array([[40, 52], [40, 84]])  # px kept free at left and top, at right and bottom, for texts and axes
_TEXT, _SMALL = 24, 20  # px
_BOUNDARY_WIDTH, _OTHER_WIDTH = 4, 2  # px

_INNER = (10, 90)  # per cent of the line ends that surely belong to the building
_REACH = 1.0  # views reach this share of the largest inner range beyond each of them; the rest are outliers
_CAMERA_SHARE = 0.62  # the camera is shown where the scale stays at least this share of what it is without it


@dataclass(frozen=True)
class _Projection:
    """From two coordinates in space, in m or units, to the pixels of a panel."""

    scale: float  # px per unit of length
    middle: Float  # (2,) shown in the middle of the panel
    centre: Float  # (2,) px, the middle of the panel

    def pixels(self, points: Float) -> Float:
        """(..., 2) px of (..., 2) coordinates."""
        result: Float = self.centre + (points - self.middle) * (self.scale, -self.scale)
        return result


def draw_view(panel: Canvas, scene: Scene, name: str, right: int, up: int) -> None:
    """Draw the lines of a scene without the coordinate that is neither `right` nor `up`."""
    ends = scene.lines.ends * metres_per_unit(scene)
    panel.fill(_PAPER)
    panel.text(16, 14, f"{name} view", _TEXT, _INK, "la")
    if len(ends):
        shows_depth = _DEPTH_AXIS in (right, up)
        low, high = (bound[[right, up]] for bound in _bounds(ends.reshape(-1, 3)))
        projection = _fit(panel, low, high, with_camera=shows_depth)
        _draw_grid(panel, projection, scene)
        _tint_faces(panel, projection, scene, right, up)
        if shows_depth:
            _draw_camera(panel, projection, scene, right, up)
        pixels = projection.pixels(ends[:, :, (right, up)])
        _draw_lines(panel, pixels, scene.lines)
        inside = ((pixels >= 0) & (pixels < (panel.width, panel.height))).all(axis=(1, 2))
        if not inside.all():
            count = int((~inside).sum())
            text = f"{count} line{'s' if count > 1 else ''} reach{'es' if count == 1 else ''} outside"
            panel.text(panel.width - 16, 14, text, _SMALL, _QUIET, "ra")
    _draw_axes(panel, right, up)
    panel.frame((0.80, 0.80, 0.82))


def _bounds(points: Float) -> tuple[Float, Float]:
    """The lowest and highest coordinates (3,) of the points that are no outliers."""
    inner = np.percentile(points, _INNER, axis=0)
    # One reach for all axes: most ends may lie in one facade, and the walls beside it are no outliers.
    reach = _REACH * float((inner[1] - inner[0]).max())
    near = (points >= inner[0] - reach) & (points <= inner[1] + reach)
    return np.where(near, points, np.inf).min(axis=0), np.where(near, points, -np.inf).max(axis=0)


def _fit(panel: Canvas, low: Float, high: Float, with_camera: bool) -> _Projection:
    """The largest scale that shows all between two corners, and on demand the camera where it stands near."""
    alone = _projection(panel, low, high)
    together = _projection(panel, np.minimum(low, 0.0), np.maximum(high, 0.0))
    return together if with_camera and together.scale >= _CAMERA_SHARE * alone.scale else alone


def _projection(panel: Canvas, low: Float, high: Float) -> _Projection:
    room = np.array([panel.width, panel.height]) - _EDGES.sum(axis=0)
    extent = high - low
    largest = float(extent.max()) or 1.0
    # A scene may be flat as seen from here: a single line has no height.
    scale = float((room / np.maximum(extent, 0.01 * largest)).min())
    return _Projection(scale, (low + high) / 2, _EDGES[0] + (room - 1) / 2)


def _draw_grid(panel: Canvas, projection: _Projection, scene: Scene) -> None:
    """Light lines one scale bar apart, and the bar itself with its length."""
    length = _round_length(0.28 * panel.width / projection.scale)
    half = np.array([panel.width, panel.height]) / projection.scale
    for axis in range(2):
        first = math.ceil((projection.middle[axis] - half[axis]) / length)
        last = math.floor((projection.middle[axis] + half[axis]) / length)
        for step in range(first, last + 1):
            at = float(projection.pixels(np.full(2, step * length))[axis])
            if axis == 0:
                panel.line((at, 0), (at, panel.height), _GRID, 1)
            else:
                panel.line((0, at), (panel.width, at), _GRID, 1)
    x, y, bar = panel.width - 20, panel.height - 22, length * projection.scale
    panel.line((x - bar, y), (x, y), _INK, 3)
    for end in (x - bar, x):
        panel.line((end, y - 6), (end, y + 6), _INK, 3)
    unit = "m" if scene.metres_per_unit is not None else "unit" if length == 1 else "units"
    panel.text(x - bar / 2, y - 12, f"{length:g} {unit}", _SMALL, _INK, "ms")


def _round_length(longest: float) -> float:
    """The largest of 1, 2 or 5 times a power of ten that is not longer."""
    power = 10.0 ** math.floor(math.log10(longest))
    return power * max(step for step in (1, 2, 5) if step * power <= longest * (1 + 1e-9))


def _tint_faces(panel: Canvas, projection: _Projection, scene: Scene, right: int, up: int) -> None:
    """The faces that this view looks at straight."""
    axis = 3 - right - up
    shown = [face for plane, face in scene.faces if plane.axis == axis and not plane.tilt]
    factor = metres_per_unit(scene)
    rings = [[projection.pixels(ring[:, (right, up)] * factor) for ring in (f.outline, *f.holes)] for f in shown]
    panel.tint(rings, line_colour(axis, True), _FACE_OPACITY)


def _draw_camera(panel: Canvas, projection: _Projection, scene: Scene, right: int, up: int) -> None:
    """The camera with the edges of what it sees, where it stands inside the view."""
    at = projection.pixels(np.zeros(2))
    if not ((at >= 0) & (at < (panel.width, panel.height))).all():
        return
    camera = scene.camera
    corners = np.array([[x, y, 1.0] for x in (0, camera.width - 1) for y in (0, camera.height - 1)])
    rays = (corners @ np.linalg.inv(camera.matrix).T @ scene.rotation)[:, (right, up)]
    forward = scene.rotation[2][[right, up]]
    angles = np.arctan2(*rays.T[::-1]) - np.arctan2(*forward[::-1])
    angles = (angles + np.pi) % (2 * np.pi) - np.pi
    for ray in (rays[angles.argmin()], rays[angles.argmax()]):
        end = at + 60.0 * ray / np.linalg.norm(ray) * (1, -1)
        panel.line(at.tolist(), end.tolist(), _QUIET, 2)
    panel.disc(at.tolist(), 6, _INK)
    panel.text(float(at[0]), float(at[1]) + 14, "camera", _SMALL, _QUIET, "ma")


def _draw_lines(panel: Canvas, pixels: Float, lines: Lines) -> None:
    """What has the full colour over what is paler, and boundaries over other lines."""
    bands = bands_of(lines)
    full = lines.component == 0 if bands is None else bands != GUESS
    for number in np.lexsort((lines.is_boundary, full)).tolist():
        colour = line_colour(int(lines.axis[number]), bool(full[number]))
        start, end = pixels[number].tolist()
        width = _BOUNDARY_WIDTH if lines.is_boundary[number] else _OTHER_WIDTH
        if math.dist(start, end) < width:
            panel.disc(start, width, colour)  # the line runs along the view
        else:
            panel.line(start, end, colour, width)


def _draw_axes(panel: Canvas, right: int, up: int) -> None:
    x, y, arm = 24, panel.height - 24, 44
    for axis, (dx, dy) in ((right, (1, 0)), (up, (0, -1))):
        colour = line_colour(axis, True)
        tip = (x + arm * dx, y + arm * dy)
        panel.line((x, y), tip, colour, 3)
        for side in (1, -1):
            panel.line(tip, (tip[0] - 10 * dx + 6 * side * dy, tip[1] - 10 * dy + 6 * side * dx), colour, 3)
        panel.text(tip[0] + 16 * dx, tip[1] + 16 * dy, AXES[axis], _TEXT, colour, "mm")
