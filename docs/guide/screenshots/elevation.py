"""The picture of docs/guide/elevations.md: the elevation of a sample, as a PDF viewer shows its page.

    python docs/guide/screenshots/elevation.py

Needs pdftoppm (Debian: poppler-utils).
"""

import subprocess
import tempfile
from pathlib import Path

from PIL import Image

from linecad.cli.main import main

GUIDE = Path(__file__).resolve().parents[1]
PHOTO = GUIDE.parents[1] / "samples" / "street.jpg"
DPI, WIDTH, QUALITY = 300, 1500, 85  # drawn finer than shown: thin pens stay thin

with tempfile.TemporaryDirectory() as folder:
    scene, page = Path(folder) / "street.json", Path(folder) / "street.pdf"
    camera = ["--camera", str(PHOTO.with_suffix(".json"))]
    drawn = ["--photo", str(PHOTO), *camera, "--camera-height", "1.6", "-o", str(page), "--quiet"]
    if main(["convert", str(PHOTO), *camera, "-o", str(scene), "--quiet"]) or main(["elevation", str(scene), *drawn]):
        raise SystemExit(1)
    picture = Path(folder) / "page"
    subprocess.run(["pdftoppm", "-r", str(DPI), "-png", "-singlefile", str(page), str(picture)], check=True)
    with Image.open(picture.with_suffix(".png")) as image:
        size = (WIDTH, round(image.height * WIDTH / image.width))
        shown = image.convert("RGB").resize(size, Image.Resampling.LANCZOS)
        shown.save(GUIDE / "elevations.jpg", quality=QUALITY, optimize=True)
