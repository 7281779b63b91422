"""One picture of a model: the photo beside the exported file as its own camera sees it, and from where it was not."""

import tempfile
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from exporters.picture.canvas import Canvas
from linecad.evaluation.turned.glb import GlbModel, read_glb
from linecad.evaluation.turned.raster import View, colour_of, draw_triangles, paint, visible_lines
from linecad.evaluation.turned.views import views_of
from linecad.io.files import write_atomically
from linecad.outputs import write_outputs
from linecad.scene import Scene

WIDTH = 720  # px of a picture
COLUMNS, GAP, TITLE, TITLE_SIZE = 3, 8, 26, 17  # pictures beside each other; px
PAPER, INK = (1.0, 1.0, 1.0), (0.15, 0.15, 0.17)
QUALITY = 88  # of 100, where it is written as JPEG
SHIFT = 4  # bits after the point in OpenCV's coordinates


def draw_view(model: GlbModel, view: View, with_lines: bool = True) -> NDArray[np.uint8]:
    """One picture (H, W, 3) RGB of everything in a model."""
    drawn = draw_triangles(model, view)
    picture = paint(model, view, drawn)
    if with_lines:
        pieces, owner = visible_lines(model.lines, view, drawn)
        fixed = np.round(pieces * 2**SHIFT).astype(int)
        colours = [colour_of(material) for material in model.materials]
        for (start, end), material in zip(fixed.tolist(), model.line_material[owner].tolist(), strict=True):
            cv2.line(picture, start, end, colours[material], 1, cv2.LINE_AA, SHIFT)
    return picture


def write_panels(scene: Scene, photo: NDArray[np.uint8], name: str, path: Path) -> None:
    """Write the scene as GLB with the photo (H, W, 3) on its faces, and the pictures of that file to `path`.

    The suffix of `path` chooses the format of the picture. Raises OutputError.
    """
    with tempfile.TemporaryDirectory() as folder:
        glb = Path(folder) / "model.glb"
        write_outputs(scene, photo, [glb], {})
        picture = draw_panels(read_glb(glb), photo, name)
    write_atomically(path, lambda file: picture.save(file, quality=QUALITY))


def draw_panels(model: GlbModel, photo: NDArray[np.uint8] | None, name: str, with_lines: bool = True) -> Image.Image:
    """The photo (H, W, 3), where it may be shown, and five pictures of a model on one picture."""
    views = views_of(model, WIDTH)
    height = views[0].height
    size = (WIDTH, height)
    pictures = []
    if photo is not None:
        pictures.append(("the photo", np.asarray(cv2.resize(photo, size, interpolation=cv2.INTER_AREA), np.uint8)))
    pictures += [(view.name, draw_view(model, view, with_lines)) for view in views]
    rows = -(-len(pictures) // COLUMNS)
    canvas = Canvas(COLUMNS * (WIDTH + GAP) + GAP, rows * (height + TITLE + GAP) + GAP, PAPER)
    for number, (title, picture) in enumerate(pictures):
        row, column = divmod(number, COLUMNS)
        left, top = GAP + column * (WIDTH + GAP), GAP + row * (height + TITLE + GAP)
        canvas.text(left, top + TITLE - 8, f"{name}: {title}" if number == 0 else title, TITLE_SIZE, INK)
        canvas.window(left, top + TITLE, WIDTH, height).pixels[:] = picture
    return canvas.image()
