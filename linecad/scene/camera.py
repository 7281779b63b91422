"""The camera of a photo, and how sure it is."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float, freeze
from linecad.scene.words import QUALITIES, CameraSource, Quality


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera with square pixels: `pixel ~ matrix @ (x, y, z)` in the camera frame.

    The photo that everything is measured in has been undistorted and its pixels made square; `distortion` only
    records what was removed.
    """

    width: int  # px
    height: int  # px
    matrix: Float  # (3, 3) K, px; K[0, 0] == K[1, 1]
    source: CameraSource
    distortion: tuple[float, ...] = ()  # OpenCV's coefficients, as they were before the photo was undistorted
    is_resampled: bool = False  # its pixels were not square and were made so
    taken_fy: float | None = None  # px, fy of the photo as it was taken; None: it is fx, or the scene does not tell

    def __post_init__(self) -> None:
        freeze(self, "matrix", np.float64, (3, 3))
        if self.width < 1 or self.height < 1:
            raise ValueError(f"Camera is {self.width} x {self.height} px, expected positive sizes")
        if not (self.matrix[0, 0] > 0 and self.matrix[1, 1] > 0):
            raise ValueError(f"Camera has focal lengths {self.matrix[0, 0]} and {self.matrix[1, 1]}, expected positive")
        if self.taken_fy is not None and not 0 < self.taken_fy < np.inf:
            raise ValueError(f"Camera.taken_fy is {self.taken_fy}, expected a positive number")
        if self.matrix[2].tolist() != [0.0, 0.0, 1.0]:
            raise ValueError(f"Camera.matrix ends in {self.matrix[2].tolist()}, expected [0, 0, 1]")

    @property
    def focal(self) -> float:
        """Focal length in px."""
        return float(self.matrix[0, 0])

    @property
    def is_given(self) -> bool:
        """Whether the user gave the focal length, so that it is not estimated."""
        return self.source in ("file", "focal option")


@dataclass(frozen=True, eq=False)
class Certainty:
    """How sure a camera and its Manhattan frame are: standard errors, and what they mean in plain words.

    An error is None where the quantity was given and not estimated.
    """

    rotation: Float  # (3,) rad, of small turns about x, y and z of the camera
    focal: float | None  # px
    center: tuple[float, float] | None  # px, of the principal point
    radial: float | None  # of OpenCV's k1
    quality: Quality
    reason: str  # for the quality: one clause, without a full stop

    def __post_init__(self) -> None:
        freeze(self, "rotation", np.float64, (3,))
        if self.quality not in QUALITIES:
            raise ValueError(f"Certainty.quality is {self.quality!r}, expected {', '.join(QUALITIES)}")
        errors = [*self.rotation.tolist(), self.focal, *(self.center or ()), self.radial]
        if any(error is not None and not 0 <= error < np.inf for error in errors):
            raise ValueError(f"Certainty holds the standard errors {errors}, expected numbers from 0")
