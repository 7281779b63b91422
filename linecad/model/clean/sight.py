"""The photo that lines are seen in: where they lie in it, and whether it shows that a line goes on.

An edge is a step of brightness. Where a line goes on, the step across its continuation has the sign that it has across
the line and nearly half of its height in both halves of the way. No contrast of its own is asked for, so that the faint
joints of a wall and the dark frames of its windows are judged alike.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float
from linecad.geometry import project, unit_normals
from linecad.scene import Camera

Float32 = NDArray[np.float32]

SAMPLES = 32  # along a stretch
BESIDE = np.arange(-3, 4, dtype=np.float32)  # px, by how much an edge may lie beside the line that became of it
AROUND = np.arange(-1, 2, dtype=np.float32)  # px, by how much more it may lie beside the line where it goes on
APART = np.float32(1.5)  # px to both sides of an edge, between which its step is measured
SMOOTHING = 1.0  # px
PARTS = 2  # of a stretch, each of which must show the edge
LEAST_STEP = 0.4  # of the median step across the line, in each part
NEAREST = 1e-6  # depth; points that are nearer, or behind the camera, have no pixel


@dataclass(frozen=True, eq=False)
class Sight:
    """A photo and how it was taken."""

    matrix: Float  # (3, 3) px
    rotation: Float  # (3, 3) world to camera
    grey: Float32 | None  # (H, W) smoothed; None: there is no photo, and it shows nothing

    @classmethod
    def of(cls, camera: Camera, rotation: Float, pixels: NDArray[np.uint8] | None) -> "Sight":
        """The sight of a photo of `pixels` (H, W, 3) RGB."""
        if pixels is None:
            return cls(camera.matrix, rotation, None)
        grey = cv2.GaussianBlur(cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY), (0, 0), SMOOTHING)
        return cls(camera.matrix, rotation, np.asarray(grey, np.float32))

    @property
    def forward(self) -> Float:
        """(3,) the camera's z in the world."""
        forward: Float = self.rotation[2]
        return forward

    def pixels(self, points: Float) -> Float:
        """Pixels (..., 2) of world points (..., 3), nan where the camera does not have them before it."""
        before = points @ self.forward > NEAREST
        pixels = np.full((*points.shape[:-1], 2), np.nan)
        pixels[before] = project(points[before], self.matrix, self.rotation)
        return pixels

    def shows(self, lines: Float, ways: Float) -> Bool:
        """Whether each of the `lines` (P, 2, 2) px goes on over its straight continuation in `ways` (P, 2, 2) px."""
        shown = np.zeros(len(lines), bool)
        known = np.flatnonzero(np.isfinite(lines).all(axis=(1, 2)) & np.isfinite(ways).all(axis=(1, 2)))
        if self.grey is None or len(known) == 0:
            return shown
        across = unit_normals(lines[known, 1] - lines[known, 0])
        typical = np.median(_steps(self.grey, lines[known], across, BESIDE), axis=2)  # (P, B)
        best = np.abs(typical).argmax(axis=1)
        step = typical[np.arange(len(known)), best][:, None]
        moved = ways[known] + (BESIDE[best, None] * across)[:, None]
        found = _steps(self.grey, moved, across, AROUND) * np.sign(step)[..., None]
        parts = found.reshape(len(known), len(AROUND), PARTS, -1).mean(axis=3).max(axis=1)
        shown[known] = (parts >= LEAST_STEP * np.abs(step)).all(axis=1) & (step[:, 0] != 0)
        return shown


def _steps(grey: Float32, ways: Float, across: Float, beside: Float32) -> Float32:
    """The steps (P, B, SAMPLES) of brightness across ways (P, 2, 2), at distances (B,) beside them."""
    share = (np.arange(SAMPLES, dtype=np.float32) + np.float32(0.5)) / SAMPLES
    ways, across = ways.astype(np.float32), across.astype(np.float32)
    along = ways[:, :1] + share[:, None] * (ways[:, 1:] - ways[:, :1])  # (P, SAMPLES, 2)

    def read(side: Float32) -> Float32:
        moved = side[:, None] * across[:, None]  # (P, B, 2)
        x, y = (np.asarray(along[:, None, :, k] + moved[..., k, None], np.float32) for k in range(2))
        return _read(grey, x, y)

    return read(beside + APART) - read(beside - APART)


def _read(grey: Float32, x: Float32, y: Float32) -> Float32:
    """The brightness (P, B, S) at places (P, B, S) px."""
    rows = len(x) * x.shape[1]
    read = cv2.remap(grey, x.reshape(rows, -1), y.reshape(rows, -1), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(read, np.float32).reshape(x.shape)
