"""Where a made photo is taken from, and the camera that this leads to at a size."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float
from linecad.geometry import rotation_about


@dataclass(frozen=True, eq=False)
class View:
    """A calibrated camera in the building frame, for photos of any size and the same shape."""

    eye: Float  # (3,) m, building frame
    yaw: float  # rad, away from the y axis, to the right
    pitch: float  # rad, upwards
    roll: float  # rad, clockwise
    focal: float  # of the photo's width
    off_centre: tuple[float, float]  # principal point off the photo's middle, of its width, right and down

    def rotation(self) -> Float:
        """(3, 3) world to camera; columns are the axes x (right), y (away) and z (up) in the camera frame."""
        ahead = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
        turns = ((2, -self.roll), (0, -self.pitch), (1, -self.yaw))
        rotation = ahead
        for axis, angle in reversed(turns):
            rotation = rotation_about(angle * np.eye(3)[axis]) @ rotation
        return rotation

    def matrix(self, width: int, height: int) -> Float:
        """(3, 3) K of a photo of this size, px."""
        x, y = (width - 1) / 2 + self.off_centre[0] * width, (height - 1) / 2 + self.off_centre[1] * width
        return np.array([[self.focal * width, 0.0, x], [0.0, self.focal * width, y], [0.0, 0.0, 1.0]])
