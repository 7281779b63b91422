"""Upright walls of bodies, and what the photo shows of them below the horizon, drawn as if seen from the front.

A wall whose scale is not known is a fan of walls, one behind the other, that look the same: where the ground meets it
tells which one it is. A *strip* shows the wall from the horizon down to the photo's border. Its rows are logs of the
height below the camera, so that the scale of the body moves a strip up or down and does not change it; its columns
follow the wall. Lines along the wall are rows, uprights are columns, and what lies on the ground before the wall leans.
Towards a ceiling it is the same, upside down.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float
from linecad.directions import UP, partner
from linecad.geometry import world_rays
from linecad.ties.planes import BodyPlane, find_planes_of_bodies, rays_before
from linecad.ties.setting import Setting

ROWS, COLUMNS = 216, 64
ROW = 0.02  # log height
FINER = 2  # samples a row and a column, which are averaged
TOP = 0.003125  # of the photo's width below the horizon, where a strip begins
BORDER = 1.5  # px
LEAST_WIDTH = 0.0104  # of the photo's width that a wall takes along the horizon
MOST_OBLIQUE = 0.05  # least depth of a wall's end over its distance: beyond, the wall runs past the camera
LEAST_SEEN = 0.1  # of a strip
WIDEST = 1600  # px of the photo: finer is not looked at
LEAST_LINES = 3
BRIGHTEST = 3.0  # Lab, added to the spread of colours, so that a plain wall's noise stays small
FINEST, COARSEST, UNIT = 5.0, 1e-3, 3.0  # of the layer of resolution: log px, px, log px

Strips = NDArray[np.float32]
WallKey = tuple[int, float, bytes]


@dataclass(frozen=True, eq=False)
class Wall:
    """An upright plane of one body."""

    body: int
    plane: BodyPlane
    offset: float  # signed, at the body's own scale
    along: tuple[float, float]  # from where to where its lines reach along its horizontal axis

    @property
    def key(self) -> "WallKey":
        """What tells it from the other walls of a photo, whatever bodies the lines are parted into."""
        return self.plane.normal, self.offset, self.plane.lines.tobytes()


@dataclass(frozen=True, eq=False)
class Strip:
    """A wall below the horizon, or above it."""

    wall: Wall
    layers: Strips  # (6, ROWS, COLUMNS): Lab less its median over its spread, is it seen, the wall's lines, resolution
    top: float  # log height of the upper border of row 0, at the body's own scale
    along: Float  # (COLUMNS,) the wall's horizontal coordinate, at the body's own scale

    def log_height(self, row: float) -> float:
        """Log of the height below the camera, or above, of the middle of a row, at the body's own scale."""
        return self.top + ROW * (row + 0.5)


def find_walls(setting: Setting) -> list[Wall]:
    """The upright walls of all bodies."""
    found = []
    for body, planes in enumerate(find_planes_of_bodies(setting)):
        for plane in planes:
            if plane.normal == 2 or len(plane.lines) < LEAST_LINES:
                continue
            offset = plane.side * float(np.exp(plane.log_offset))
            before = rays_before(setting, plane, setting.graph.segments.ends[plane.lines].reshape(-1, 2))
            at = before[:, int(partner(plane.normal))] * offset / before[:, plane.normal]
            if len(at) > LEAST_LINES:
                found.append(Wall(body, plane, offset, (float(at.min()), float(at.max()))))
    return found


def reach_below(setting: Setting, wall: Wall) -> Float:
    """How far (M,) below the camera each line of a wall reaches, at the body's own scale; -inf behind the camera."""
    sight, normal = setting.sight, wall.plane.normal
    rays = world_rays(setting.graph.segments.ends[wall.plane.lines].reshape(-1, 2), sight.matrix, sight.rotation)
    before = rays[:, normal] * wall.offset > 0
    below = np.full(len(rays), -np.inf)
    below[before] = -rays[before, UP] * wall.offset / rays[before, normal]
    return np.asarray(below.reshape(-1, 2).max(axis=1))


class StripDrawer:
    """Draws the strips of one photo's walls, from the horizon down or up. The setting must have pixels."""

    def __init__(self, setting: Setting, is_above: bool = False) -> None:
        pixels = setting.sight.pixels
        assert pixels is not None
        self._setting, self._sight = setting, setting.sight
        self._way = 1.0 if is_above else -1.0
        self._projection = setting.sight.matrix @ setting.sight.rotation
        self._shrunk = min(1.0, WIDEST / pixels.shape[1])
        size = (round(pixels.shape[1] * self._shrunk), round(pixels.shape[0] * self._shrunk))
        self._pixels = cv2.resize(pixels, size, interpolation=cv2.INTER_AREA) if self._shrunk < 1 else pixels

    def draw(self, wall: Wall) -> Strip | None:
        """The strip of a wall; None where too little of the wall is on that side of the horizon in the photo."""
        across = self._columns(wall)
        if across is None:
            return None
        along, depth = across
        width, focal = self._sight.width, self._sight.matrix[0, 0]
        top = float(np.log(TOP * width * np.median(depth) / focal))
        log_height = top + ROW / FINER * np.arange(ROWS * FINER)
        pixels, depth = self.seen_at(wall, along[None], self._way * np.exp(log_height)[:, None])
        height, width = self._pixels.shape[:2]
        at = pixels * self._shrunk
        seen = depth > 0
        for number, size in enumerate((width, height)):
            seen &= (at[..., number] > BORDER) & (at[..., number] < size - 1 - BORDER)
        if seen.mean() < LEAST_SEEN:
            return None
        colour = self._colours(at, seen)
        coarse = np.abs(np.gradient(at[..., 1], axis=0)) * (1000 / width) + COARSEST
        fine = np.clip(np.log(coarse), -FINEST, FINEST) / UNIT
        layers = np.concatenate([colour, seen[None], fine[None]]).astype(np.float32)
        layers = layers.reshape(5, ROWS, FINER, COLUMNS, FINER).mean(axis=(2, 4))
        lines = self._lines(wall, along, top).reshape(ROWS, FINER, COLUMNS, FINER).max(axis=(1, 3))
        return Strip(
            wall, np.concatenate([layers[:4], lines[None], layers[4:]]), top, along.reshape(COLUMNS, FINER).mean(axis=1)
        )

    def seen_at(self, wall: Wall, along: Float, height: Float) -> tuple[Float, Float]:
        """Pixels (..., 2) of the photo and depths (...) of points of a wall; (0, 0) for those behind the camera."""
        of_normal, of_along, of_height = self._projection[:, [wall.plane.normal, int(partner(wall.plane.normal)), 2]].T
        seen = (wall.offset * of_normal + along[..., None] * of_along) + height[..., None] * of_height
        depth = seen[..., 2]
        pixels: Float = seen[..., :2] / np.where(depth > 0, depth, np.inf)[..., None]
        return pixels, depth

    def _columns(self, wall: Wall) -> tuple[Float, Float] | None:
        """Where columns are along the wall, evenly spaced along the horizon, and how deep; None for a narrow wall."""
        along = np.linspace(*wall.along, 400)
        _, depth = self.seen_at(wall, along, np.zeros(1))
        along = along[depth > MOST_OBLIQUE * np.hypot(wall.offset, along)]
        if len(along) < 10:
            return None
        pixels, _ = self.seen_at(wall, along, np.zeros(1))
        far = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(pixels, axis=0), axis=1))]
        if far[-1] < LEAST_WIDTH * self._sight.width:
            return None
        along = np.interp(np.linspace(0, far[-1], COLUMNS * FINER), far, along)
        return along, self.seen_at(wall, along, np.zeros(1))[1]

    def _colours(self, at: Float, seen: Bool) -> Float:
        """Lab (3, R, C) of pixels (R, C, 2) of the shrunk photo, less its median and over its spread; 0 if not seen."""
        sampled = cv2.remap(
            self._pixels, at[..., 0].astype(np.float32), at[..., 1].astype(np.float32), cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_REPLICATE,
        )  # fmt: skip
        colour = cv2.cvtColor(sampled.astype(np.float32) / 255, cv2.COLOR_RGB2Lab)
        middle, spread = np.median(colour[seen], axis=0), colour[seen].std() + BRIGHTEST
        scaled: Float = ((colour - middle) / spread).transpose(2, 0, 1) * seen
        return scaled

    def _lines(self, wall: Wall, along: Float, top: float) -> NDArray[np.float32]:
        """The wall's lines drawn at the finer resolution."""
        ends = self._setting.graph.segments.ends[wall.plane.lines]
        rays = world_rays(ends, self._sight.matrix, self._sight.rotation)
        points = rays * (wall.offset / rays[..., wall.plane.normal])[..., None]
        forth = 1.0 if along[-1] >= along[0] else -1.0
        column = np.interp(forth * points[..., int(partner(wall.plane.normal))], forth * along, np.arange(len(along)))
        row = (np.log(np.maximum(self._way * points[..., 2], 1e-9)) - top) * FINER / ROW
        drawn = np.zeros((ROWS * FINER, COLUMNS * FINER), np.float32)
        corners = np.rint(np.stack([column, np.clip(row, -50, 10 * ROWS)], axis=2)).astype(np.int64)
        for first, second in corners.tolist():
            cv2.line(drawn, first, second, 1.0, 1)
        return drawn
