"""The faces' textures as formats need them: JPEG pages cut from the photo, and where each corner lies on them.

Many faces share a page, because readers open one picture and one material a page: a scene of 500 faces with a picture
each would be 500 files, and as many changes of material for whoever draws it.
"""

import hashlib
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from exporters.faces import checked_polygon
from exporters.layout import Patch, build_layout, view_of
from exporters.model import FlatFace, build_model
from exporters.rectify import paint_pages
from linecad.scene import Float, Scene

MEDIA_TYPE = "image/jpeg"
_QUALITY = 95  # of 100; the photo itself has seldom been stored better
_DIGITS = 16  # of the digest in a page's name


@dataclass(frozen=True, eq=False)
class Page:
    """One picture of textures."""

    name: str  # of the file, which says what is in it: two pages of one name are the same
    data: bytes  # JPEG
    width: int  # texels
    height: int


@dataclass(frozen=True, eq=False)
class Textures:
    """The pages of a scene and the place of each face on them."""

    pages: tuple[Page, ...]
    patches: dict[int, Patch]  # by the id of the face

    def page(self, face: FlatFace) -> int:
        """The number of the face's page."""
        return self.patches[face.id].page

    def coordinates(self, face: FlatFace) -> Float:
        """(V, 2) texture coordinates of `face.vertices`: from the lower left corner of the page, its sides are 1."""
        patch = self.patches[face.id]
        page = self.pages[patch.page]
        s, t = (patch.texels(face.vertices) / [page.width, page.height]).T
        return np.stack([s, 1.0 - t], axis=1)


def build_textures(scene: Scene, photo: NDArray[np.uint8], largest: int) -> Textures:
    """The textures of all faces from the scene's photo (H, W, 3), on pages of at most `largest` texels a side.

    Raises OutputError where the rings of a face do not bound one piece of plane.
    """
    model, view = build_model(scene), view_of(scene)
    for face in model.faces:
        checked_polygon(face)
    layout = build_layout(model, view, largest)
    pages = [_page(pixels) for pixels in paint_pages(model, layout, view, photo)]
    return Textures(tuple(pages), {face.id: patch for face, patch in zip(model.faces, layout.patches, strict=True)})


def _page(pixels: NDArray[np.uint8]) -> Page:
    settings = [cv2.IMWRITE_JPEG_QUALITY, _QUALITY]
    settings += [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444]  # red stays in its line
    _, encoded = cv2.imencode(".jpg", cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR), settings)
    data = encoded.tobytes()
    return Page(f"photo-{hashlib.sha256(data).hexdigest()[:_DIGITS]}.jpg", data, pixels.shape[1], pixels.shape[0])
