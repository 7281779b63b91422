"""Lines where they were found beside where they are, seen from where the camera was not.

Four panels as SVG, without the photo's own pixels: the plan from above and a view from the side, each with the found
lines on the left and, on the right, the same lines at their true depth.
"""

from html import escape

import numpy as np

from linecad.arrays import Bool, Float
from linecad.directions import components
from linecad.evaluation.depth import NO_LINE, depths_of, nearest_lines
from linecad.evaluation.labels import depth_on, find_true_lines
from linecad.evaluation.references import Reference
from linecad.evaluation.scopes import RIGHT
from linecad.geometry import world_rays
from linecad.line_graph import Segments
from linecad.scene import Scene

TURN = np.radians(35.0)  # of the side view about the vertical, against the camera's own direction
FALL = np.radians(20.0)  # of the side view below the horizon
WIDTH, HEIGHT, TITLE, GAP = 440, 330, 22, 12  # px, of a panel, of the line above it, and between two
MARGIN = 0.08  # of a panel's size, around the true places
OUTLIERS = 0.01  # share of ends on each side that may lie outside a panel
ROOM = 0.5  # of the size of the true places, on each side, that found ones may add to a panel
RIGHT_COLOUR, WRONG_COLOUR, UNKNOWN_COLOUR, CAMERA_COLOUR = "#0d8c40", "#d91a1a", "#b8b8bc", "#1261a0"
SIGHT = 26  # px, of the two lines from the camera along the left and right border of the photo


def draw_places(scene: Scene, reference: Reference, scale: float) -> str | None:
    """The four panels; `scale` is found over true depth of component 0. None where no line has a known place."""
    ratio = true_ratios(scene, reference)
    known = np.isfinite(ratio)
    if not known.any():
        return None
    right = known & (np.abs(ratio / scale - 1) < RIGHT)
    found, true = scene.lines.ends / scale, scene.lines.ends / ratio[:, None, None]
    counts = f"{right.sum()} right, {(known & ~right).sum()} wrong, {(~known).sum()} unknown"
    panels = []
    for row, (name, view) in enumerate((("plan", plan_view()), ("side", side_view(scene.rotation)))):
        frame = _Frame(true[known] @ view, found[known] @ view, scene, view)
        for column, (title, ends, shown) in enumerate(
            ((f"{name}, as found: {counts}", found, np.ones(len(known), bool)), (f"{name}, true", true, known))
        ):
            strokes = [
                (colour, frame.path(ends[chosen & shown] @ view))
                for colour, chosen in ((UNKNOWN_COLOUR, ~known), (RIGHT_COLOUR, right), (WRONG_COLOUR, known & ~right))
            ]
            panels.append(_panel(title, column * (WIDTH + GAP), row * (HEIGHT + TITLE + GAP), strokes, frame.camera))
    width, height = 2 * WIDTH + GAP, 2 * (HEIGHT + TITLE) + GAP
    return "\n".join(
        [
            f'<svg viewBox="0 0 {width} {height}" width="{width}" role="img" font-family="sans-serif" font-size="13">',
            *panels,
            "</svg>",
        ]
    )


def true_ratios(scene: Scene, reference: Reference) -> Float:
    """Found over true depth (N,) of each line, NaN where its true place is not known.

    A made photo tells it of every line that shows an edge, or runs in a plane, under its right axis: the ratio is that
    in the middle of the segment. Elsewhere it is the median over the points on edges to which the line gives a depth.
    """
    count = len(scene.lines)
    ratio = np.full(count, np.nan)
    if reference.truth is not None:
        segments = Segments(scene.lines.segment, scene.lines.axis)
        lines = find_true_lines(reference.truth, segments, components(scene.rotation, scene.turns))
        middle = scene.lines.segment.mean(axis=1)
        true = depth_on(reference.truth.rays(middle), lines.point, lines.direction)
        found = depths_of(scene, middle, np.arange(count))
        known = lines.right & (true > 0) & (found > 0)
        ratio[known] = found[known] / true[known]
    elif reference.edges is not None:
        pixels = reference.edges.pixels
        which = nearest_lines(scene, pixels, np.ones(count, bool))
        each = depths_of(scene, pixels, which) / reference.edges.depth
        which[~(each > 0)] = NO_LINE
        for line in np.unique(which[which != NO_LINE]):
            ratio[line] = np.median(each[which == line])
    return ratio


def plan_view() -> Float:
    """(3, 2) from world to a picture from above: x to the right, y upwards."""
    return np.array([[1.0, 0.0], [0.0, -1.0], [0.0, 0.0]])


def side_view(rotation: Float) -> Float:
    """(3, 2) from world to a parallel view that is turned and looks down; `rotation` (3, 3) is world to camera."""
    forward = rotation[2]
    heading = np.arctan2(forward[1], forward[0]) + TURN
    along = np.array([np.cos(heading), np.sin(heading), 0.0])
    right = np.array([along[1], -along[0], 0.0])
    up = np.sin(FALL) * along + np.cos(FALL) * np.array([0.0, 0.0, 1.0])
    return np.stack([right, -up], axis=1)


class _Frame:
    """The part of a view that two panels show: the camera, true ends, and found ones that are not far from these."""

    def __init__(self, true: Float, found: Float, scene: Scene, view: Float) -> None:
        low = np.minimum(np.quantile(true.reshape(-1, 2), OUTLIERS, axis=0), 0.0)  # 0: the camera
        high = np.maximum(np.quantile(true.reshape(-1, 2), 1 - OUTLIERS, axis=0), 0.0)
        room = ROOM * (high - low)
        ends = np.quantile(np.clip(found.reshape(-1, 2), low - room, high + room), [OUTLIERS, 1 - OUTLIERS], axis=0)
        low, high = np.minimum(low, ends[0]), np.maximum(high, ends[1])
        size = np.array([WIDTH, HEIGHT])
        self._scale = (1 - 2 * MARGIN) * float((size / (high - low)).min())
        self._shift = size / 2 - self._scale * (low + high) / 2
        middle = scene.camera.matrix[1, 2]
        borders = np.array([[0.0, middle], [scene.camera.width, middle]])
        sight = world_rays(borders, scene.camera.matrix, scene.rotation) @ view
        left, right = (SIGHT * sight / np.linalg.norm(sight, axis=1, keepdims=True) + self._shift).tolist()
        self.camera = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in (left, self._shift.tolist(), right))

    def path(self, ends: Float) -> str:
        """Lines (N, 2, 2) of the view as an SVG path, without those that miss the panel."""
        placed = ends * self._scale + self._shift
        shown: Bool = ((placed.max(axis=1) > 0) & (placed.min(axis=1) < [WIDTH, HEIGHT])).all(axis=1)
        return "".join(f"M{a:.1f} {b:.1f}L{c:.1f} {d:.1f}" for a, b, c, d in placed[shown].reshape(-1, 4).tolist())


def _panel(title: str, left: int, top: int, strokes: list[tuple[str, str]], camera: str) -> str:
    """One panel: colours with their paths in the order of drawing, and the path of the camera."""
    lines = [
        f'<text x="{left + 2}" y="{top + TITLE - 7}">{escape(title)}</text>',
        f'<svg x="{left}" y="{top + TITLE}" width="{WIDTH}" height="{HEIGHT}" overflow="hidden" fill="none" '
        'stroke-linecap="round">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" stroke="#ccc"/>',
        # Round caps: in the plan a vertical line is a dot.
        *(f'<path d="{path}" stroke="{colour}" stroke-width="1.4"/>' for colour, path in strokes if path),
        f'<path d="{camera}" stroke="{CAMERA_COLOUR}" stroke-width="1.5"/>',
        "</svg>",
    ]
    return "\n".join(lines)
