"""What hides a window is not on it: it shows what the photo shows of an equal one that is in plain view."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from exporters.faces import FlatFace
from exporters.model import Model
from exporters.textures.behind import mix
from exporters.textures.layout import MARGIN

_Pixels = NDArray[np.uint8]


def fill_from_equal(
    model: Model, painted: dict[int, _Pixels], covers: dict[int, _Pixels], shown: dict[int, float]
) -> None:
    """Change the patches of faces that something hides, in place, to those of equal ones that nothing hides.

    By the id of the face: `painted` its patch with its margin (H, W, 3), `covers` (H, W) 255 where something hides it,
    and `shown` how many pixels of the photo show it. Faces without such an equal one stay as they are.
    """
    for fittings in model.equal_fittings:
        for faces in zip(*(fitting.faces for fitting in fittings), strict=True):
            source = _seen_best(faces, painted, covers, shown)
            for face in faces:
                if source is not None and face.id in covers and face.id in painted:
                    _lay(painted[source.id], painted[face.id], covers[face.id])


def _seen_best(
    faces: Sequence[FlatFace], painted: dict[int, _Pixels], covers: dict[int, _Pixels], shown: dict[int, float]
) -> FlatFace | None:
    """The face that nothing hides and most pixels show, the first of several; None where there is none."""
    clear = [face for face in faces if face.id in painted and face.id not in covers and shown[face.id] > 0]
    return max(clear, key=lambda face: shown[face.id], default=None)


def _lay(source: _Pixels, colours: _Pixels, cover: _Pixels) -> None:
    """Change a patch, in place, to another of a face of the same size where it is covered."""
    inner = np.s_[MARGIN:-MARGIN, MARGIN:-MARGIN]
    rows, columns = colours[inner].shape[:2]
    laid = cv2.resize(source[inner], (columns, rows), interpolation=cv2.INTER_AREA)
    mix(colours[inner], np.asarray(laid, np.uint8), cover[inner])
