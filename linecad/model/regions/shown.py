"""What every part of the photo was taken for, as a picture that people can look at."""

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.model.regions.filling import Filled
from linecad.model.regions.partition import FIXED_POINT, polygons_of
from linecad.model.regions.raster import COLUMNS
from linecad.scene import Camera, CellKind, Cells


def cells_of(filled: Filled, camera: Camera) -> Cells:
    """The labels of all cells, with the clutter that hides some of them and the roofs before them."""
    labels, step = filled.labels, camera.width / COLUMNS
    surfaces: list[CellKind] = [surface.kind for surface in labels.surfaces]
    roofs: list[CellKind] = ["roof"] * len(filled.roofs)
    number = labels.label[labels.cell].reshape(-1, COLUMNS).astype(np.uint8)
    for own, roof in enumerate(filled.roofs, labels.clutter + 1):
        _fill(number, roof.polygon, own, step)
    _fill(number, filled.clutter, labels.clutter, step)
    return Cells(number, (*surfaces, "sky", "clutter", *roofs))


def _fill(image: NDArray[np.uint8], shape: shapely.Geometry, value: int, step: float) -> None:
    """Paint the samples inside a shape (px); what lies in its holes stays."""
    for polygon in [] if shape.is_empty else polygons_of(shape):
        rings = [shapely.get_coordinates(ring) for ring in (polygon.exterior, *polygon.interiors)]
        corners = [np.rint(((ring + 0.5) / step - 0.5) * 2**FIXED_POINT).astype(np.int32) for ring in rings]
        cv2.fillPoly(image, corners, value, shift=FIXED_POINT)
