"""The photo on a coarse raster: rays, colours, the axes its edges run along, and the lines of the scene.

What a part of the photo shows is asked of some hundred thousand samples and not of the pixels: the raster has COLUMNS
across whatever the photo's size, so that lengths in samples mean the same in every photo.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int, true_places
from linecad.depth.normals import UNTOLD, Normals
from linecad.directions import Turns, components
from linecad.geometry import depths_beside, directions_to, vanishing_points, world_rays
from linecad.scene import Camera, Lines

COLUMNS = 480  # of samples across the photo
FINER = 2  # times as fine a raster is where the directions of edges are measured
EDGE = 0.35  # gradient, in units of the noise that light itself has; a stronger one is an edge
DARK = 8.0  # grey value that is added before the square root, so that black has some noise
ALONG_AXIS = np.sin(np.radians(8.0))  # of the angle between an edge and an image line through a vanishing point
SHADES = 512  # in which colours are told apart: 8 of lightness, 8 of each hue
GREEN = (123, 131)  # of CIE a* and b*, in bytes; less of the first and more of the second is green
DIM, DIM_GREEN = 70, (128, 3)  # below that L*, in bytes: less a*, and more b* than a* by so much
LIT = 0.25  # least share of a plant that is green, not dim
LEAVES = 13  # samples around one, whose edges tell whether leaves are there
MANY_EDGES, ASTRAY = 0.3, 0.4  # pixels of edges a sample among leaves, and the share of them along no axis
LEAST_PLANT, LEAST_LEAF = 0.002, 3  # of the photo; samples across, narrower green is none
BETWEEN_LEAVES = 9  # samples; dark gaps that are no wider are the plant's

Picture = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Raster:
    """S = H x W samples of a photo, row by row, and T points on the lines of the scene."""

    shape: tuple[int, int]  # H, W
    step: float  # px between samples
    rays: Float  # (S, K) components along all directions, camera depth 1
    colour: Picture  # (H, W, 3) CIE L*a*b* as OpenCV has it in bytes
    gradient: Float  # (S,) of the grey value, in units of its noise
    votes: Float  # (S, K + 1) edge pixels along each direction and along none
    facing: Int  # (S,) axis along which what it shows faces by a depth map, or UNTOLD
    line: Int  # (T,) line of each point
    at: Int  # (T,) sample in which the point lies
    line_rays: Float  # (T, K)
    line_depth: Float  # (T,)
    opened: Int  # (S,) axis along which a wall faces by its openings, or UNTOLD
    opened_cost: Float  # (S,) of what says otherwise
    turns: Turns = ()  # of further frames
    map_depth: Float | None = None  # (S,) camera depth by a depth map, in the scene's unit; NaN where it has none
    map_width: float = 0.0  # log depth, Cauchy's, to which it is believed

    @property
    def size(self) -> int:
        """S."""
        return self.shape[0] * self.shape[1]

    @cached_property
    def shade(self) -> Int:
        """The colour (S,) of each sample as one of SHADES."""
        smooth = cv2.GaussianBlur(self.colour, (0, 0), 1.0).reshape(-1, 3).astype(np.int64)
        hues = np.clip((smooth[:, 1:] - 88) // 10, 0, 7)
        shade: Int = smooth[:, 0] // 32 * 64 + hues[:, 0] * 8 + hues[:, 1]
        return shade

    @cached_property
    def plants(self) -> Bool:
        """Mask (S,) of trees, hedges and bushes: green, and full of edges that mostly run along no axis."""
        colour = cv2.GaussianBlur(self.colour, (0, 0), 1.5)
        votes = cv2.blur(self.votes.astype(np.float32).reshape(*self.shape, -1), (LEAVES, LEAVES))
        edges = votes.sum(axis=2)
        rough = (edges > MANY_EDGES) & (votes[:, :, -1] > ASTRAY * edges)
        light, red, yellow = (colour[:, :, channel].astype(np.int64) for channel in range(3))
        green = (red < GREEN[0]) & (yellow > GREEN[1])
        dim = (light < DIM) & (red < DIM_GREEN[0]) & (yellow - red > DIM_GREEN[1])  # in the dark all is nearly grey
        leaf = np.ones((LEAST_LEAF, LEAST_LEAF), np.uint8)
        gap = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (BETWEEN_LEAVES, BETWEEN_LEAVES))
        solid = cv2.morphologyEx(((green | dim) & rough).astype(np.uint8), cv2.MORPH_OPEN, leaf)
        count, part = cv2.connectedComponents(cv2.morphologyEx(solid, cv2.MORPH_CLOSE, gap), connectivity=8)
        area = np.bincount(part.ravel(), minlength=count)
        is_plant = (area >= LEAST_PLANT * self.size) & (np.bincount(part[green & rough], minlength=count) > LIT * area)
        is_plant[0] = False
        found: Bool = is_plant[part.ravel()]
        return found

    def marked(self, points: Bool) -> Bool:
        """Mask (S,) of the samples with one of the masked points (T,)."""
        mask = np.zeros(self.size, bool)
        mask[self.at[points]] = True
        return mask

    def distance(self, marked: Bool) -> Float:
        """Distance (S,), in samples, to the nearest masked one (S,); inf where there is none."""
        if not marked.any():
            return np.full(self.size, np.inf)
        image = np.where(marked, 0, 1).astype(np.uint8).reshape(self.shape)
        return np.asarray(cv2.distanceTransform(image, cv2.DIST_L2, 5).ravel(), np.float64)

    def inside(self, shape: shapely.Geometry) -> Bool:
        """Mask (S,) of the samples whose middles lie in a shape, px."""
        inside = np.zeros(self.shape, bool)
        if shape.is_empty:
            return inside.ravel()
        left, top, right, bottom = self.samples_of(np.array(shape.bounds).reshape(2, 2)).ravel()
        rows, columns = (
            slice(max(0, int(top)), max(0, int(bottom) + 2)),
            slice(max(0, int(left)), max(0, int(right) + 2)),
        )
        x, y = ((np.arange(count) + 0.5) * self.step - 0.5 for count in self.shape[::-1])
        shapely.prepare(shape)
        inside[rows, columns] = shapely.contains_xy(shape, *np.meshgrid(x[columns], y[rows]))
        return inside.ravel()

    def samples_of(self, pixels: Float) -> Float:
        """Places (..., 2) on the raster, in samples, of pixels (..., 2)."""
        places: Float = (pixels + 0.5) / self.step - 0.5
        return places


def take_raster(
    lines: Lines,
    camera: Camera,
    rotation: Float,
    photo: Picture | None,
    normals: Normals | None = None,
    turns: Turns = (),
) -> Raster:
    """The raster of a photo (H, W, 3) RGB as straight as the lines; without one no sample has an edge.

    `rotation` (3, 3) takes world to camera, `turns` are those of further frames; `normals` are those of a depth map on
    the photo's pixels.
    """
    axes = components(rotation, turns)
    step = camera.width / COLUMNS
    shape = (max(1, round(camera.height / step)), COLUMNS)
    pixels = _pixels(shape, step)
    if photo is None:
        photo = np.full((*shape, 3), 128, np.uint8)
    facing = np.full(len(pixels), UNTOLD)
    if normals is not None:
        at_x, at_y = np.minimum(np.rint(pixels).astype(np.int64), [camera.width - 1, camera.height - 1]).T
        facing = normals.axes_at(at_y, at_x, axes)
    small = np.asarray(cv2.resize(photo, shape[::-1], interpolation=cv2.INTER_AREA), np.uint8)
    line, at, points = _points_on_lines(lines, shape, step)
    rays = world_rays(points, camera.matrix, axes)
    return Raster(
        shape=shape,
        step=step,
        rays=np.asfortranarray(world_rays(pixels, camera.matrix, axes)),  # planes look at one component of all
        colour=np.asarray(cv2.cvtColor(small, cv2.COLOR_RGB2LAB), np.uint8),
        gradient=_gradients(_grey(small), 0.7)[2].ravel(),
        votes=_votes(photo, shape, step, camera, axes),
        facing=facing,
        opened=np.full(len(pixels), UNTOLD),
        opened_cost=np.zeros(len(pixels)),
        line=line,
        at=at,
        line_rays=rays,
        line_depth=depths_beside(rays, components(lines.ends[line, 0], turns), lines.axis[line]),
        turns=turns,
    )


def _pixels(shape: tuple[int, int], step: float) -> Float:
    """Pixels (H x W, 2) of the photo at the middles of samples of `step` px."""
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    pixels: Float = np.column_stack([columns.ravel() + 0.5, rows.ravel() + 0.5]) * step - 0.5
    return pixels


def _points_on_lines(lines: Lines, shape: tuple[int, int], step: float) -> tuple[Int, Int, Float]:
    """Points on all segments, closer than samples: the line (T,), the sample (T,) and the pixel (T, 2) of each."""
    length = np.linalg.norm(lines.segment[:, 1] - lines.segment[:, 0], axis=1)
    count = np.ceil(1.5 * length / step).astype(np.int64) + 2
    line = np.repeat(np.arange(len(lines)), count)
    share = (np.arange(len(line)) - np.repeat(np.cumsum(count) - count, count)) / np.repeat(count - 1, count)
    points = lines.segment[line, 0] + share[:, None] * (lines.segment[line, 1] - lines.segment[line, 0])
    column, row = np.floor((points.T + 0.5) / step).astype(np.int64)
    inside = (column >= 0) & (column < shape[1]) & (row >= 0) & (row < shape[0])
    return line[inside], (row * shape[1] + column)[inside], points[inside]


def _grey(photo: Picture) -> NDArray[np.uint8]:
    return np.asarray(cv2.cvtColor(photo, cv2.COLOR_RGB2GRAY), np.uint8)


def _gradients(grey: NDArray[np.uint8], blur: float) -> tuple[Float, Float, Float]:
    """Gradients (H, W) of a grey picture across and down, and their length in units of the noise of its light."""
    smooth = cv2.GaussianBlur(grey.astype(np.float32), (0, 0), blur)
    across, down = (cv2.Sobel(smooth, cv2.CV_32F, *order, ksize=3) / 8 for order in ((1, 0), (0, 1)))
    light = cv2.GaussianBlur(smooth, (0, 0), 6 * blur) + DARK
    return across, down, np.asarray(np.hypot(across, down) / np.sqrt(light))


def _votes(photo: Picture, shape: tuple[int, int], step: float, camera: Camera, axes: Float) -> Float:
    """How many pixels (S, K + 1) of edges along `axes` (3, K) and along none a finer raster has in each sample."""
    fine = (shape[0] * FINER, shape[1] * FINER)
    resized = np.asarray(cv2.resize(photo, fine[::-1], interpolation=cv2.INTER_AREA), np.uint8)
    across, down, strength = _gradients(_grey(resized), 0.8)
    row, column = true_places(strength > EDGE)
    pixels = np.column_stack([column + 0.5, row + 0.5]) * (step / FINER) - 0.5
    along = np.column_stack([-down[row, column], across[row, column]])
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    none = axes.shape[1]
    sines = np.empty((none, len(row)))
    for axis, point in enumerate(vanishing_points(camera.matrix, axes)):
        to = directions_to(pixels, point)
        sines[axis] = np.abs(along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0])
    votes_for = np.where(sines.min(axis=0) < ALONG_AXIS, sines.argmin(axis=0), none)
    sample = (row // FINER) * shape[1] + column // FINER
    votes = np.bincount(sample * (none + 1) + votes_for, minlength=shape[0] * shape[1] * (none + 1))
    return votes.reshape(-1, none + 1).astype(np.float64)


def traced(mask: Bool, step: float, least_hole: float) -> list[shapely.Polygon]:
    """Polygons, px, through the outermost samples of the parts of a mask (H, W) of samples of `step` px.

    With their holes of a share `least_hole` of the mask or more. Thin parts touch themselves, and are not valid.
    """
    rings, nested = cv2.findContours(mask.astype(np.uint8), cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    found = []
    for number, ring in enumerate(rings):
        if nested[0, number, 3] < 0 and len(ring) > 2:
            inner = [hole for other, hole in enumerate(rings) if nested[0, other, 3] == number and len(hole) > 2]
            holes = [hole for hole in inner if cv2.contourArea(hole) >= least_hole * mask.size]
            found.append(shapely.Polygon(_middles(ring, step), [_middles(hole, step) for hole in holes]))
    return found


def _middles(ring: NDArray[Any], step: float) -> Float:
    """Pixels (N, 2) at the middles of samples (N, 1, 2)."""
    pixels: Float = (ring[:, 0].astype(np.float64) + 0.5) * step - 0.5
    return pixels


def grab(picture: Picture, start: Bool, rest: Bool, rounds: int) -> Bool:
    """What of a picture (H, W, 3) looks more like `start` (H, W) than like all else, of which `rest` (H, W) is sure.

    GrabCut: Rother, Kolmogorov and Blake, SIGGRAPH 2004. What is in both is of the start.
    """
    told = np.where(rest, cv2.GC_BGD, cv2.GC_PR_BGD).astype(np.uint8)
    told[start] = cv2.GC_FGD
    cv2.setRNGSeed(0)  # the mixtures of colours start at random; the same photo gives the same parts
    cv2.grabCut(picture, told, (0, 0, 0, 0), np.zeros((1, 65)), np.zeros((1, 65)), rounds, cv2.GC_INIT_WITH_MASK)
    return np.asarray((told == cv2.GC_FGD) | (told == cv2.GC_PR_FGD))
