"""Where a face is seen at so flat an angle that a pixel of the photo is a streak on it: a far road, a long floor.

A streak shows nothing that is there, but it looks like something once the model is turned. So the colours are made as
coarse along the way on which streaks are short as they are along the streaks, and get the grain that the face has where
it is seen well.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from exporters.textures.grain import add_grain
from linecad.arrays import Bool, Float

STREAKED, WHOLLY_STREAKED = 10.0, 20.0  # texels that a pixel is long where it begins to show, and where no detail stays
_SPREAD = 0.4  # of the length of a streak: the standard deviation by which colours are spread
_FEW = 8  # a side of the squares of texels for which the length is computed once

_Pixels = NDArray[np.uint8]


def streaks(to_photo: Float, size: tuple[int, int]) -> NDArray[np.float32]:
    """(rows, columns) how many texels long a pixel is, 0 where the plane is not before the camera.

    `to_photo` (3, 3) takes column, row and 1 of a texel to the photo; `size` is columns and rows.
    """
    few = [-(-side // _FEW) for side in size]
    at = np.meshgrid(*((np.arange(count) + 0.5) * _FEW for count in few))
    u, v, w = (to_photo @ np.stack([*at, np.ones_like(at[0])]).reshape(3, -1)).reshape(3, *at[0].shape)
    before = w > 0
    w = np.where(before, w, 1.0)
    (a, b), (c, d) = (
        [(to_photo[row, column] - point / w * to_photo[2, column]) / w for column in range(2)]
        for row, point in enumerate((u, v))
    )
    # The smaller singular value of the derivative, by the sum and the product of the squares of both.
    sum_of_squares, product = a * a + b * b + c * c + d * d, np.abs(a * d - b * c)
    larger = np.sqrt((sum_of_squares + np.sqrt(np.maximum(sum_of_squares**2 - 4 * product**2, 0.0))) / 2)
    length = np.where(before, larger / np.maximum(product, 1e-12), 0.0).astype(np.float32)
    return np.asarray(cv2.resize(length, (few[0] * _FEW, few[1] * _FEW))[: size[1], : size[0]], np.float32)


def without_streaks(colours: _Pixels, known: Bool, length: NDArray[np.float32]) -> None:
    """Change colours (H, W, 3), in place, where a pixel is a streak; they hold where they are `known` (H, W).

    `length` (H, W) is that of `streaks`.
    """
    share = np.clip((length - STREAKED) / (WHOLLY_STREAKED - STREAKED), 0.0, 1.0)
    streaked = known & (share > 0)
    if not streaked.any():
        return
    weight = known.astype(np.float32)
    spread = _SPREAD * WHOLLY_STREAKED
    summed = cv2.GaussianBlur(colours * weight[..., None], (0, 0), spread)
    coarse = np.rint(summed / np.maximum(cv2.GaussianBlur(weight, (0, 0), spread), 1e-3)[..., None]).astype(np.uint8)
    add_grain(coarse, colours, known & ~streaked, streaked)
    part = share[streaked][:, None]
    colours[streaked] = np.rint(colours[streaked] * (1 - part) + coarse[streaked] * part).astype(np.uint8)
