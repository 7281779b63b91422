"""Windows and doors of a scene against the true ones of a made photo."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import shapely
from scipy.optimize import linear_sum_assignment

from linecad.arrays import Bool, Float, Int
from linecad.dataset.truth import NOTHING, TrueOpenings, Truth, planes_of
from linecad.geometry import PhotoLength, project
from linecad.model.openings.corners import rectangle_in_space
from linecad.scene import OpeningKind, Plane, Scene

OVERLAP = 0.5  # intersection over union in the photo, from which an opening is found
RELIEF = 0.3  # m before a wall: what stands further before it hides it
VISIBLE = 0.5  # share of an opening's pixels that must show it, for it to count
INSIDE = 0.9  # share of it that must lie in the photo
LEAST_SIDE = PhotoLength(30.0)  # of a square as large as the smallest opening that counts
FEWEST_LINES = 6  # that a facade must show to be in the scene
NEAREST = 0.1  # m of depth; what reaches nearer to the camera is not projected


@dataclass(frozen=True)
class OpeningScore:
    """Openings of one kind, those of component 0 or all."""

    right: int  # found ones that are true
    found: int  # that were found, without those where nothing can be said
    true: int  # that can be seen

    @property
    def f1(self) -> float | None:
        """Harmonic mean of precision and recall; None where there is nothing to find and nothing was found."""
        return 2 * self.right / (self.found + self.true) if self.found + self.true else None


def windows_f1(scene: Scene, truth: Truth, everywhere: bool = False) -> float | None:
    """F1 of the windows at overlap 0.5; None where the truth tells no openings, or neither side has windows."""
    scored = score_openings(scene, truth, "window", everywhere)
    return None if scored is None else scored.f1


def score_openings(scene: Scene, truth: Truth, kind: OpeningKind, everywhere: bool = False) -> OpeningScore | None:
    """Score the openings of one kind; None where the truth does not tell them.

    A true opening counts where the photo shows most of it and its facade, the plane of one building, is in component 0:
    at least FEWEST_LINES lines of that component show the facade, and at least as many as of all others together. A
    found one counts where its plane is of component 0, as half of its lines are, and where it is no true one that does
    not count and does not lie on a facade that does not.

    `everywhere` counts all that the photo shows and all that was found.
    """
    if truth.openings is None:
        return None
    known = truth.openings
    facade = _facades(known)
    shown = np.array([shape_in_photo(truth, corners) for corners in known.corners], object)
    own = known.is_door == (kind == "door")
    is_in = _facades_in_scene(scene, truth, facade)[facade]
    is_in |= everywhere
    is_there = np.array([shape is not None for shape in shown], bool)
    counts = own & is_there & is_in
    for row in np.flatnonzero(counts).tolist():
        counts[row] = _is_visible(truth, known.corners[row], shown[row])
    found = _found_shapes(scene, kind, everywhere)
    targets = np.flatnonzero(own & is_there)
    pairs = _pairs(found, [shown[row] for row in targets])
    excused = {i for i, j in pairs if not counts[targets[j]]}
    right = len(pairs) - len(excused)
    others = [shape for i, shape in enumerate(found) if i not in {i for i, _ in pairs}]
    false = sum(_lies_on_counted(truth, known, is_in, shape) for shape in others)
    return OpeningScore(right, right + false, int(counts.sum()))


def _facades(known: TrueOpenings) -> Int:
    """The facade (O,) of each opening, counted from 0: the plane of one building."""
    normal, offset = planes_of(known.corners)
    turned = np.where(normal[np.arange(len(normal)), np.abs(normal).argmax(axis=1)] < 0, -1, 1)
    keys = np.column_stack([known.body, np.rint(100 * normal * turned[:, None]), np.rint(100 * offset * turned)])
    _, facade = np.unique(keys, axis=0, return_inverse=True)
    return np.asarray(facade, np.int64).ravel()


def _facades_in_scene(scene: Scene, truth: Truth, facade: Int) -> Bool:
    """Which facades (F,) are in component 0, by the lines that show them."""
    known = truth.openings
    assert known is not None
    pixels = scene.lines.segment.mean(axis=1)
    quads = truth.quad_at(pixels)
    shown = quads != NOTHING
    pixels, quads, is_first = pixels[shown], quads[shown], (scene.lines.component == 0)[shown]
    points = truth.rays(pixels) * truth.quad_depth(pixels, quads)[:, None]
    normal, offset = planes_of(known.corners)
    there = np.zeros(facade.max(initial=-1) + 1, bool)
    for number in range(len(there)):
        first = int(np.flatnonzero(facade == number)[0])
        on = (np.abs(points @ normal[first] - offset[first]) <= RELIEF) & (truth.body[quads] == known.body[first])
        there[number] = (on & is_first).sum() >= max(FEWEST_LINES, on.sum() / 2)
    return there


def shape_in_photo(truth: Truth, corners: Float) -> shapely.Polygon | None:
    """An opening (4, 3) in the photo; None where it is too small or too much of it lies outside."""
    if (corners @ truth.rotation[2] < NEAREST).any():
        return None
    shape = shapely.Polygon(project(corners, truth.matrix, truth.rotation))
    photo = shapely.box(-0.5, -0.5, truth.width - 0.5, truth.height - 0.5)
    is_large = shape.area >= LEAST_SIDE.px(truth.width) ** 2
    return shape if is_large and shape.intersection(photo).area >= INSIDE * shape.area else None


def _is_visible(truth: Truth, corners: Float, shape: shapely.Polygon) -> bool:
    """Whether most pixels of an opening show its wall or what is behind it."""
    mask = np.zeros((truth.height, truth.width), np.uint8)
    cv2.fillPoly(mask, [np.rint(shapely.get_coordinates(shape)[:-1]).astype(np.int32)], 1)
    row, column = np.nonzero(mask)
    pixels = np.column_stack([column, row]).astype(np.float64)
    quads = truth.ids[row, column]
    points = truth.rays(pixels) * truth.quad_depth(pixels, quads)[:, None]
    normal, offset = planes_of(corners[None])
    # The camera is at the origin, so that it is on the side of the wall where the sign is that of -offset.
    before = (offset - points @ normal[0]) * np.sign(offset)
    return bool(np.mean((quads != NOTHING) & (before <= RELIEF)) >= VISIBLE)


def _found_shapes(scene: Scene, kind: OpeningKind, everywhere: bool) -> list[shapely.Polygon]:
    """The found openings of one kind in the photo: those on planes of component 0, or all."""
    component = dict(zip(scene.lines.id.tolist(), scene.lines.component.tolist(), strict=True))
    planes = {plane.id: plane for plane in scene.planes if everywhere or _is_of_first(plane, component)}
    own = [each for each in scene.openings if each.kind == kind and each.plane in planes]
    corners = [rectangle_in_space(each, planes[each.plane], scene.turns) for each in own]
    return [
        shapely.Polygon(project(ring, scene.camera.matrix, scene.rotation))
        for ring in corners
        if (ring @ scene.rotation[2] > 0).all()
    ]


def _is_of_first(plane: Plane, component: dict[int, int]) -> bool:
    """Whether at least half of a plane's lines, which have a `component` each, are in component 0."""
    first = sum(component[line] == 0 for line in plane.lines)
    return first > 0 and 2 * first >= len(plane.lines)


def _pairs(found: Sequence[shapely.Polygon], true: Sequence[shapely.Polygon]) -> list[tuple[int, int]]:
    """Found and true ones that overlap enough, each at most once, the most overlap in sum."""
    if not (found and true):
        return []
    one, other = np.array(found, object)[:, None], np.array(true, object)[None]
    overlap = shapely.area(shapely.intersection(one, other)) / shapely.area(shapely.union(one, other))
    overlap = np.where(overlap >= OVERLAP, overlap, 0.0)
    rows, columns = linear_sum_assignment(-overlap)
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if overlap[i, j] > 0]


def _lies_on_counted(truth: Truth, known: TrueOpenings, is_in: Bool, shape: shapely.Polygon) -> bool:
    """Whether a found opening that is none counts as false: not on a facade that does not count."""
    middle = shapely.get_coordinates(shape.centroid)
    quad = truth.quad_at(middle)
    if quad[0] == NOTHING:
        return True
    point = truth.rays(middle)[0] * truth.quad_depth(middle, quad)[0]
    normal, offset = planes_of(known.corners)
    on = (np.abs(normal @ point - offset) <= RELIEF) & (known.body == truth.body[quad[0]])
    return not on.any() or bool(is_in[on].any())
