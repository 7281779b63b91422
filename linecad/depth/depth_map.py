"""The record of a depth map, and what its readers share: its limits, and the error for a file that is none.

*Kinds*: `z` runs along the optical axis, `distance` along the ray of its pixel; `inverse` is 1 / z but for its scale,
`affine-inverse` but for scale and shift. Lengths are in units of the file: their scale is not to be trusted.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, freeze
from linecad.depth.normals import Normals
from linecad.errors import DepthMapError
from linecad.scene import DEPTH_KINDS, DepthKind

Kind: TypeAlias = DepthKind
Single = NDArray[np.float32]

SMALLEST_SIDE = 16  # px; the coarsest networks write 256
LARGEST_SIDE = 32766  # px, the longest side of a photo that can be undistorted
MOST_PIXELS = 2**26  # as many as the largest photos of phones have, and a third more
MOST_BYTES = 2**30  # of a file, or of one array in it: points of MOST_PIXELS in single precision
WHAT_TO_GIVE = "a .npz, .npy, .exr, .pfm, 16-bit .png, .tiff of floating-point numbers or a phone's .heic"
WHAT_TO_ASK_FOR = (
    "ask the network for its numbers: depth.exr (MoGe --maps), .npz (Depth Pro -o, Depth Anything 3 mini_npz), "
    ".npy (Depth Anything 2 --save-numpy), .pfm (MiDaS)"
)


@dataclass(frozen=True, eq=False)
class DepthMap:
    """How far away what each pixel shows is, as far as a file tells."""

    name: str  # file name, without its folder
    values: Single  # (H, W) above 0 where valid, 0 elsewhere; what they measure says `kind`
    valid: Bool  # (H, W)
    kind: Kind | None  # None: the file does not tell
    intrinsics: Float | None = None  # (3, 3) K in px of this map, as the file counts them; None: not in the file
    normals: Normals | None = None  # of the same pixels; None: not in the file

    def __post_init__(self) -> None:
        freeze(self, "values", np.float32, (None, None))
        shape = self.values.shape
        freeze(self, "valid", np.bool_, shape)
        if self.kind is not None and self.kind not in DEPTH_KINDS:
            raise ValueError(f"DepthMap.kind is {self.kind}, expected None or one of {', '.join(DEPTH_KINDS)}")
        if ((self.values > 0) != self.valid).any() or (self.values < 0).any():
            raise ValueError("DepthMap.values are not above 0 where valid and 0 elsewhere")
        if self.intrinsics is not None:
            freeze(self, "intrinsics", np.float64, (3, 3))
        if self.normals is not None and self.normals.shape != shape:
            raise ValueError(f"DepthMap.normals has shape {self.normals.shape}, expected {shape}")

    @property
    def width(self) -> int:
        """Width in px of the map."""
        return int(self.values.shape[1])

    @property
    def height(self) -> int:
        """Height in px of the map."""
        return int(self.values.shape[0])


@dataclass(frozen=True)
class Reading:
    """What a file may not tell of itself."""

    array: str | None = None  # which array of an .npz holds the depth; None: found by its name
    view: int | None = None  # which photo, from 0, where a file holds the depth of several; None: it holds one
    factor: float | None = None  # of 16-bit pictures, units a step; None: PNG_FACTOR


@dataclass(frozen=True, eq=False)
class Content:
    """What a reader finds in a file, its numbers as they stand there."""

    values: NDArray[Any]  # (H, W)
    kind: Kind | None = None
    intrinsics: Float | None = None  # (3, 3) px of the map
    normals: NDArray[Any] | None = None  # (H, W, 3); bytes are MoGe's colours
    mask: Bool | None = None  # (H, W) false where the network says that there is nothing; None: it does not say


def camera_depths(values: Float, slant: Float, kind: Kind, shift: float = 0.0) -> Float:
    """Camera depth, in units of the map, of its numbers (...); NaN where a map of that kind and shift has none.

    `slant` (...) is the distance of a point of depth 1 on the ray of each; `shift` is added, by affine-inverse alone.
    """
    shifted = values + shift if kind == "affine-inverse" else values
    depth = np.where(shifted > 0, shifted, np.nan)
    if kind in ("inverse", "affine-inverse"):
        return np.asarray(1 / depth, np.float64)
    return np.asarray(depth / slant if kind == "distance" else depth, np.float64)


def check_size(width: int, height: int, path: Path) -> None:
    """Raise DepthMapError where a map of that size is too small or too large; called before memory is taken for it."""
    if min(width, height) < SMALLEST_SIDE:
        raise DepthMapError(
            f"{path} has {width} x {height} px, too small for a depth map; give one of at least {SMALLEST_SIDE} px "
            "on each side"
        )
    if width * height > MOST_PIXELS or max(width, height) > LARGEST_SIDE:
        raise DepthMapError(f"{path} has {width} x {height} px, more than linecad takes; scale it down to the photo's")
