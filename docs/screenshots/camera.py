"""The picture of docs/camera.md, what `linecad camera` draws of a sample: python docs/screenshots/camera.py"""

import tempfile
from pathlib import Path

from PIL import Image

from linecad.cli.main import main

DOCS = Path(__file__).resolve().parent.parent
PHOTO = DOCS.parent / "samples" / "street.jpg"
WIDTH, QUALITY = 1200, 85  # px and out of 100: legible, and small in the repository

with tempfile.TemporaryDirectory() as folder:
    drawn = Path(folder) / "camera.png"
    if main(["camera", str(PHOTO), "-o", str(drawn), "--quiet"]) != 0:
        raise SystemExit(1)
    with Image.open(drawn) as picture:
        size = (WIDTH, round(picture.height * WIDTH / picture.width))
        picture.resize(size, Image.Resampling.LANCZOS).save(DOCS / "camera.jpg", quality=QUALITY, optimize=True)
