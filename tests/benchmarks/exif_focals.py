"""How far the focal length of EXIF is from the true one: python tests/benchmarks/exif_focals.py DATASET ...

DATASET is a folder of photos, each with its camera matrix beside it as `K` in NAME.json. Every photo is read as it is
and after edits that keep its EXIF data: resized to half, cropped by 30 % of its width, cropped by 30 % of its width and
20 % of its height; each crop once more with the size of what is left written into EXIF, as editors do. For each edit
the median and the largest error of the focal length, the largest in standard errors of it, and how often the
crop history was found to be what.
"""

import argparse
import json
import math
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from statistics import median

from PIL import Image
from PIL.ExifTags import IFD, Base

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from linecad.camera.photo import read_photo

Edit = Callable[[Image.Image], Image.Image]
CUT = 0.3  # of the width
CUT_TOO = 0.2  # of the height


def half(image: Image.Image) -> Image.Image:
    """The photo at half its size."""
    return image.resize((image.width // 2, image.height // 2))


def narrower(image: Image.Image) -> Image.Image:
    """The photo without its right side."""
    return image.crop((0, 0, round(image.width * (1 - CUT)), image.height))


def smaller(image: Image.Image) -> Image.Image:
    """The photo without its right side and its top."""
    return image.crop((0, round(image.height * CUT_TOO), round(image.width * (1 - CUT)), image.height))


# Name, edit, focal length for one px of the old one, whether the size in EXIF is rewritten.
EDITS: list[tuple[str, Edit, float, bool]] = [
    ("as it is", lambda image: image, 1.0, False),
    ("half", half, 0.5, False),
    ("narrower", narrower, 1.0, False),
    ("narrower, rewritten", narrower, 1.0, True),
    ("smaller", smaller, 1.0, False),
    ("smaller, rewritten", smaller, 1.0, True),
]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    photos = [path for folder in parser.parse_args().datasets for path in sorted(folder.glob("*.jpg"))]
    print(f"{'':20} photos found  median  worst  in errors  crop")
    with tempfile.TemporaryDirectory() as folder:
        for name, edit, scale, is_rewritten in EDITS:
            measure(name, edit, scale, is_rewritten, photos, Path(folder) / "photo.jpg")


def measure(name: str, edit: Edit, scale: float, is_rewritten: bool, photos: list[Path], scratch: Path) -> None:
    """Print the row of one edit."""
    errors, in_standard_errors, crops = [], [], Counter[str]()
    for path in photos:
        with Image.open(path) as image:
            exif = image.getexif()
            edited = edit(image.convert("RGB"))
        if is_rewritten:
            camera = exif.get_ifd(IFD.Exif)
            camera[Base.ExifImageWidth], camera[Base.ExifImageHeight] = edited.size
        edited.save(scratch, exif=exif, quality=50)
        photo = read_photo(scratch)
        crops[photo.crop] += 1
        if photo.exif_focal is not None:
            truth = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))["K"][0][0] * scale
            errors.append(photo.exif_focal.focal / truth - 1)
            in_standard_errors.append(abs(math.log(photo.exif_focal.focal / truth)) / photo.exif_focal.relative_error)
    if errors:
        worst = max(errors, key=abs)
        figures = f"{median(errors):+7.1%} {worst:+6.1%} {max(in_standard_errors):10.1f}"
    else:
        figures = f"{'-':>7} {'-':>6} {'-':>10}"
    print(f"{name:20} {len(photos):6} {len(errors):5} {figures}  {dict(crops)}")


if __name__ == "__main__":
    main()
