"""What a made photo tells of the faces, pixel by pixel: the right axis, the right plane, the ground.

*Clutter* is what needs no plane of a draughtsman: bodies of a horizontal size below CLUTTER, such as cars, trees and
furniture, and surfaces along no axis.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.dataset.truth import NOTHING, Truth
from linecad.evaluation.draughting.ground import ground_rows
from linecad.evaluation.draughting.shapes import NO_FACE, Shape
from linecad.evaluation.frames import true_axes
from linecad.scene import Scene

CLUTTER = 6.0  # m
MANHATTAN = np.cos(np.radians(1.0))  # of the angle between the normal of a quad and an axis
RIGHT = 0.05  # relative error of a depth or a height
SEEN = 0.02  # of the photo's pixels that show ground, where one ground face is due
ONE_GROUND = 0.8  # of the largest true ground plane, by pixels, that one face must cover to be the ground
SAME_PLANE = 0.005  # m


@dataclass(frozen=True)
class TrueCounts:
    """Pixels of a grid that show what a draughtsman would draw as planes."""

    pixels: int
    covered: int  # that show any face
    right_axis: int
    right_plane: int  # right axis, and depth within RIGHT
    sky: int  # pixels of the grid that show the sky
    sky_covered: int  # of them, those that show a face, and should not
    ground_height: float | None  # found over true height of the camera above the ground, less 1; None: no pixel tells
    ground_covered: float | None  # of the largest true ground plane, by one face; None where no ground is seen

    @property
    def has_right_height(self) -> bool | None:
        """Whether the ground is at its height within RIGHT; None where no ground is seen."""
        if self.ground_covered is None:
            return None
        return self.ground_height is not None and abs(self.ground_height) < RIGHT

    @property
    def has_one_ground(self) -> bool | None:
        """Whether one face covers the ground that is seen; None where none is."""
        return None if self.ground_covered is None else self.ground_covered >= ONE_GROUND


@dataclass(frozen=True, eq=False)
class Shown:
    """What pixels show: of the scene and of the truth."""

    pixels: Float  # (M, 2) px
    face: Int  # (M,) place in `scene.faces`, NO_FACE for none
    depth: Float  # (M,) camera depth of the face, in the scene's unit


def compare_faces(scene: Scene, shapes: list[Shape], shown: Shown, truth: Truth, scale: float | None) -> TrueCounts:
    """The faces against the truth; `scale` is found over true depth, without which no depth is right."""
    quad = truth.quad_at(shown.pixels)
    normal, offset = truth.planes()
    axis = np.where(np.abs(normal).max(axis=1) >= MANHATTAN, np.abs(normal).argmax(axis=1), NOTHING)
    drawn = (quad != NOTHING) & (axis[quad] != NOTHING) & ~is_clutter(truth)[quad]
    has = drawn & (shown.face != NO_FACE)
    names = true_axes(scene.rotation, truth.rotation)  # both frames are turned against the same camera
    known = {axis: int(name) for axis, name in enumerate(names)}  # a wall of a further frame has none of these axes
    found_axis = np.array([known.get(shape.plane.axis, NOTHING) for shape in shapes] + [NOTHING])[shown.face]
    right_axis = has & (found_axis == axis[quad])
    ratio = np.full(len(quad), np.nan)
    if scale is not None:
        ratio[has] = shown.depth[has] / truth.quad_depth(shown.pixels[has], quad[has]) / scale
    with np.errstate(invalid="ignore"):
        right_plane = right_axis & (np.abs(ratio - 1) < RIGHT)
    height, covered = _ground(shapes, shown, quad, drawn & _is_ground(axis, normal, offset)[quad], offset, scale)
    return TrueCounts(
        pixels=int(drawn.sum()),
        covered=int(has.sum()),
        right_axis=int(right_axis.sum()),
        right_plane=int(right_plane.sum()),
        sky=int((quad == NOTHING).sum()),
        sky_covered=int(((quad == NOTHING) & (shown.face != NO_FACE)).sum()),
        ground_height=height,
        ground_covered=covered,
    )


def is_clutter(truth: Truth) -> Bool:
    """Which quads (Q,) belong to small bodies."""
    count = int(truth.body.max(initial=-1)) + 1
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    np.minimum.at(low, truth.body, truth.quads[..., :2].min(axis=1))
    np.maximum.at(high, truth.body, truth.quads[..., :2].max(axis=1))
    small: Bool = (high - low).max(axis=1) < CLUTTER
    return small[truth.body]


def _is_ground(axis: Int, normal: Float, offset: Float) -> Bool:
    """Which quads (Q,) are level and below the camera, which is the origin."""
    level: Bool = (axis == 2) & (offset * normal[:, 2] < 0)
    return level


def _ground(
    shapes: list[Shape], shown: Shown, quad: Int, is_ground: Bool, offset: Float, scale: float | None
) -> tuple[float | None, float | None]:
    """Relative error of the ground's height, and how much of the largest ground plane one face covers."""
    if is_ground.sum() < SEEN * len(quad):
        return None, None
    heights = np.abs(offset[quad[is_ground]])
    values, count = np.unique(np.round(heights / SAME_PLANE).astype(np.int64), return_counts=True)
    main = is_ground.copy()
    main[is_ground] = np.abs(heights - values[count.argmax()] * SAME_PLANE) <= SAME_PLANE
    level = np.array([not shape.is_upright for shape in shapes] + [False])
    on = shown.face[main & level[shown.face]]
    covered = float(np.bincount(on).max() / main.sum()) if len(on) else 0.0
    seen = np.bincount(shown.face[shown.face != NO_FACE], minlength=len(shapes))
    ground = np.isin(shown.face, ground_rows(shapes, seen))
    both = ground & is_ground
    if scale is None or both.sum() <= ground.sum() / 2:
        return None, covered  # what was taken for the ground is something else
    found = np.abs(np.array([shape.plane.offset for shape in shapes]))[shown.face[both]]
    return float(np.median(found / np.abs(offset[quad[both]])) / scale - 1), covered
