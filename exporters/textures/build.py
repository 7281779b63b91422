"""Builds the textures of a scene from its photo, as JPEG pages.

JPEG, because photos are, and every reader of glTF, USD and OBJ reads it; as PNG the pages of a photo take ten times
the room.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from exporters.model import build_model
from exporters.textures.behind import OWN
from exporters.textures.layout import build_layout, view_of
from exporters.textures.pages import Page, Textures, page_name
from exporters.textures.rectify import paint_pages
from exporters.triangulation import checked_polygon
from linecad.scene import Scene

_QUALITY = 95  # of 100; the photo itself has seldom been stored better


def build_textures(scene: Scene, photo: NDArray[np.uint8], largest: int, fill: str = OWN) -> Textures:
    """The textures of all faces from the scene's photo (H, W, 3), on pages of at most `largest` texels a side.

    `fill`, one of FILLS, is what is painted where the scene tells a face as hidden. Raises OutputError where the
    rings of a face do not bound one piece of plane.
    """
    model, view = build_model(scene), view_of(scene)
    for face in model.faces:
        checked_polygon(face)
    layout = build_layout(model, view, largest)
    painted, shown = paint_pages(model, layout, view, photo, fill)
    ids = [face.id for face in model.faces]
    return Textures(
        pages=tuple(map(_page, painted)),
        patches=dict(zip(ids, layout.patches, strict=True)),
        shown=dict(zip(ids, shown, strict=True)),
    )


def _page(pixels: NDArray[np.uint8]) -> Page:
    data = jpeg_of(pixels)
    return Page(page_name(data), data, pixels.shape[1], pixels.shape[0])


def jpeg_of(pixels: NDArray[np.uint8]) -> bytes:
    """A picture (H, W, 3) RGB as JPEG."""
    settings = [cv2.IMWRITE_JPEG_QUALITY, _QUALITY]
    settings += [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444]  # red stays in its line
    _, encoded = cv2.imencode(".jpg", cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR), settings)
    return bytes(encoded.tobytes())
