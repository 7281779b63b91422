"""The faces' textures as formats need them: pages of pictures, and where each corner lies on them.

Many faces share a page, because readers open one picture and one material a page: a scene of 500 faces with a picture
each would be 500 files, and as many changes of material for whoever draws it.
"""

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from exporters.faces import FlatFace
from exporters.textures.layout import Patch
from linecad.arrays import Float

MEDIA_TYPE = "image/jpeg"
PAGE_NAME = re.compile(r"photo-[0-9a-f]{16}\.jpg")  # what `page_name` returns
_DIGITS = 16  # of the digest in a page's name


def page_name(data: bytes) -> str:
    """The name of the file of a page, which says what is in it: two pages of one name are the same."""
    return f"photo-{hashlib.sha256(data).hexdigest()[:_DIGITS]}.jpg"


@dataclass(frozen=True, eq=False)
class Page:
    """One picture of textures."""

    name: str  # of `page_name`
    data: bytes  # JPEG
    width: int  # texels
    height: int


@dataclass(frozen=True, eq=False)
class Textures:
    """The pages of a scene and the place of each face on them."""

    pages: tuple[Page, ...]
    patches: dict[int, Patch]  # by the id of the face
    shown: dict[int, float]  # by the id of the face, how many pixels of the photo show it

    @property
    def files(self) -> Mapping[str, bytes]:
        """The pages as files, by name."""
        return {page.name: page.data for page in self.pages}

    def page(self, face: FlatFace) -> int:
        """The number of the face's page."""
        return self.patches[face.id].page

    def best_shown(self, faces: Sequence[FlatFace]) -> FlatFace:
        """The face that most pixels of the photo show, the first of several."""
        return max(faces, key=lambda face: self.shown[face.id])

    def coordinates(self, face: FlatFace, eye: Float) -> Float:
        """(V, 2) texture coordinates of `face.vertices`: from the lower left corner of the page, its sides are 1.

        `eye` (3,) is where the camera stands in the face's frame.
        """
        patch = self.patches[face.id]
        page = self.pages[patch.page]
        s, t = (patch.texels(face.vertices - eye) / [page.width, page.height]).T
        return np.stack([s, 1.0 - t], axis=1)
