"""What each part of the photo shows: a wall, the ground, the sky. For people to look at; no scene file has it."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import freeze

CellKind = Literal["wall", "level", "kerb", "ground", "ceiling", "roof", "sky", "clutter"]
CELL_KINDS: tuple[CellKind, ...] = get_args(CellKind)


@dataclass(frozen=True, eq=False)
class Cells:
    """The surfaces of a scene, its sky and what has no plane, on a raster over the whole photo."""

    number: NDArray[np.uint8]  # (H, W) row in `kinds` of what each sample shows
    kinds: tuple[CellKind, ...]  # of each surface; walls are several

    def __post_init__(self) -> None:
        freeze(self, "number", np.uint8, (None, None))
        if self.number.size and int(self.number.max()) >= len(self.kinds):
            raise ValueError(f"Cells.number goes up to {self.number.max()}, but {len(self.kinds)} kinds are named")
        if unknown := set(self.kinds) - set(CELL_KINDS):
            raise ValueError(f"Cells.kinds has {min(unknown)!r}, expected {', '.join(CELL_KINDS)}")
