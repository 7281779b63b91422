"""A photo in tiles: level 0 at full size, each next level half as large, the last one in a single tile."""

import threading
from collections import OrderedDict

import cv2
import numpy as np
from numpy.typing import NDArray

TILE = 512  # px along a side
QUALITY = 90  # of the JPEG
KEPT = 256  # tiles that are kept as JPEG, about 15 MB


class Pyramid:
    """The tiles of one photo; may be asked from several threads."""

    def __init__(self, pixels: NDArray[np.uint8]) -> None:
        """`pixels` (H, W, 3) RGB."""
        self._levels = [pixels]
        while max(self._levels[-1].shape[:2]) > TILE:
            self._levels.append(_halved(self._levels[-1], pixels.shape, len(self._levels)))
        self._kept: OrderedDict[tuple[int, int, int], bytes] = OrderedDict()
        self._lock = threading.Lock()

    @property
    def levels(self) -> int:
        """How many levels there are."""
        return len(self._levels)

    def tile(self, level: int, column: int, row: int) -> bytes | None:
        """The JPEG of a tile, smaller than TILE at the right and lower border; None where there is none."""
        if not 0 <= level < len(self._levels) or column < 0 or row < 0:
            return None
        image = self._levels[level]
        part = image[row * TILE : (row + 1) * TILE, column * TILE : (column + 1) * TILE]
        if part.size == 0:
            return None
        key = (level, column, row)
        with self._lock:
            if key in self._kept:
                self._kept.move_to_end(key)
                return self._kept[key]
        _, data = cv2.imencode(".jpg", part[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
        with self._lock:
            self._kept[key] = data.tobytes()
            while len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        return data.tobytes()


def _halved(image: NDArray[np.uint8], full: tuple[int, ...], level: int) -> NDArray[np.uint8]:
    """The next level: ceil(full / 2**level) px, by averages of areas."""
    height, width = (-(-side // 2**level) for side in full[:2])
    return np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8)
