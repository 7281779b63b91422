"""The picture of docs/guide/camera.md, what `linecad camera` draws of a sample.

python docs/guide/screenshots/camera.py
"""

import tempfile
from pathlib import Path

from PIL import Image

from linecad.cli.main import main

GUIDE = Path(__file__).resolve().parents[1]
PHOTO = GUIDE.parents[1] / "samples" / "street.jpg"
WIDTH, QUALITY = 1200, 85  # px and out of 100: legible, and small in the repository

with tempfile.TemporaryDirectory() as folder:
    drawn = Path(folder) / "camera.png"
    if main(["camera", str(PHOTO), "-o", str(drawn), "--quiet"]) != 0:
        raise SystemExit(1)
    with Image.open(drawn) as picture:
        size = (WIDTH, round(picture.height * WIDTH / picture.width))
        picture.resize(size, Image.Resampling.LANCZOS).save(GUIDE / "camera.jpg", quality=QUALITY, optimize=True)
