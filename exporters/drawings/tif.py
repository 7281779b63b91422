"""TIFF 6.0 of the photo beneath a drawing, to scale: https://www.loc.gov/preservation/digital/formats/fdd/fdd000022.shtml

Its resolution says how large it is printed: at the scale of the drawing. The world file beside it tells programs with
coordinates where it lies, in drawing metres.
"""

from pathlib import Path

from PIL import Image

from exporters.beside import Names, SideFiles
from exporters.drawings.records import Drawing, Picture
from linecad.errors import OutputError

_DESCRIPTION, _SOFTWARE = 270, 305  # tags


def write(drawing: Drawing, path: Path, names: Names | None) -> SideFiles:
    """Write the picture to `path`, and return its world file. Raises OutputError where there is none, or OSError."""
    picture = drawing.picture
    if picture is None:
        raise OutputError("a TIFF holds the rectified photo, and no photo is at hand; name it with --photo")
    told = f"{drawing.title}; {drawing.unit_note}".encode("ascii", "replace").decode("ascii")
    Image.fromarray(picture.pixels).save(
        path,
        format="TIFF",
        compression="tiff_adobe_deflate",
        dpi=(picture.dpi, picture.dpi),
        tiffinfo={_DESCRIPTION: told, _SOFTWARE: "linecad"},
    )
    assert names is not None, "the row of the format has a library"
    return SideFiles({}, world_file(picture))


def world_file(picture: Picture) -> str:
    """Six numbers: the step along x, two turns, the step along y, and the centre of the first pixel."""
    step, half = picture.step, picture.step / 2
    numbers = (step, 0.0, 0.0, -step, picture.left + half, picture.top - half)
    return "".join(f"{number!r}\n" for number in map(float, numbers))
