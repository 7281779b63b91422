"""Normals of surfaces, by which a map tells which of three axes a face has.

Frame: the camera's, x right, y down, z forward. A large map has millions of them and few are looked at, so that they
stay as the file has them, and are made one long where somebody asks.
"""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float, Int

NO_NORMAL = 127  # of red, green and blue in MoGe's pictures
STEPS = 255
SIGNS = np.array([1, -1, -1])  # MoGe colours a normal by (x, -y, -z), from -1 to 1 as 0 to 255
LENGTHS = (0.5, 1.5)  # of a vector that means a normal; others are fillings
OUTSIDE = -1  # a row of pixels that nothing of the file is seen in
UNTOLD = -1  # the axis of pixels without a normal, or whose normal is near none
MOST_TURNED = np.radians(30.0)  # from an axis; networks bend rooms by 1 to 4 degrees, and normals at edges by more

Place = NDArray[np.int16]


@dataclass(frozen=True, eq=False)
class Normals:
    """The normals of a map (H, W)."""

    vectors: NDArray[Any]  # (h, w, 3) as the file has them; bytes are MoGe's colours
    places: tuple[Place, Place] | None = None  # row and column in it of each px, to be broadcast to (H, W); None: same

    def __post_init__(self) -> None:
        if self.vectors.ndim != 3 or self.vectors.shape[2] != 3:
            raise ValueError(f"Normals.vectors has shape {self.vectors.shape}, expected (h, w, 3)")
        vectors = self.vectors.view()
        vectors.flags.writeable = False
        object.__setattr__(self, "vectors", vectors)

    @property
    def shape(self) -> tuple[int, ...]:
        """H and W of the map."""
        return self.vectors.shape[:2] if self.places is None else np.broadcast_shapes(*(p.shape for p in self.places))

    def laid(self, row: NDArray[np.integer[Any]], column: NDArray[np.integer[Any]]) -> Self:
        """For a map whose pixels are at those rows and columns of this one, both to be broadcast to its (H, W).

        What is at row OUTSIDE has none.
        """
        if self.places is not None:
            raise ValueError("Normals are laid onto a photo already")
        return replace(self, places=(row.astype(np.int16), column.astype(np.int16)))  # LARGEST_SIDE fits

    def at(self, row: Int, column: Int) -> Float:
        """The normals (N, 3) of pixels, of length 1; 0 where there is none."""
        if self.places is not None:
            row, column = (np.broadcast_to(place, self.shape)[row, column].astype(np.int64) for place in self.places)
        found = self.vectors[row, column]
        if found.dtype == np.uint8:
            # The writer cut off the fraction: the middle of a step is nearest to what was there.
            vectors = ((found + 0.5) * (2 / STEPS) - 1) * SIGNS
            vectors[(found == NO_NORMAL).all(axis=1)] = 0
        else:
            vectors = found.astype(np.float64)
        with np.errstate(all="ignore"):
            length = np.linalg.norm(vectors, axis=1)
            good = (length > LENGTHS[0]) & (length < LENGTHS[1]) & (row != OUTSIDE)
            normals: Float = np.where(good[:, None], vectors / length[:, None], 0.0)
        return normals

    def axes_at(self, row: Int, column: Int, rotation: Float) -> Int:
        """The world axis (N,) along which what pixels show faces, or UNTOLD; `rotation` (3, 3) is camera from world."""
        along = np.abs(self.at(row, column) @ rotation)
        axes: Int = np.where(along.max(axis=1) >= np.cos(MOST_TURNED), along.argmax(axis=1), UNTOLD)
        return axes
