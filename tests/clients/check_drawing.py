"""Open a drawing in pdftoppm and pdftotext (poppler) and in Inkscape: check_drawing.py FILE.pdf FILE.svg

Both show the same page: of the same size, with ink in the same places, and the text of the PDF can be read.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageFilter

from verdict import run

DPI = 100
APART = 4  # px at this resolution, 1 mm: how far ink of one may lie from ink of the other; fonts differ
DARK = 140  # of 255: from here down a pixel is ink
STRAY = 0.1  # of the ink, that may lie elsewhere: letters of another font do; at a scale that is 1 % off 0.3 do
LIMIT = 120  # s


def check(findings, pdf, svg):
    """Note all problems of the two files; returns a summary."""
    with tempfile.TemporaryDirectory() as folder:
        page, drawing = Path(folder) / "pdf.png", Path(folder) / "svg.png"
        start("pdftoppm", "-r", DPI, "-png", "-singlefile", pdf, page.with_suffix(""))
        start("inkscape", svg, "--export-type=png", f"--export-dpi={DPI}", f"--export-filename={drawing}")
        one, other = (np.asarray(Image.open(path).convert("L")) for path in (page, drawing))
    text = start("pdftotext", "-layout", pdf, "-")
    for words in ("Scale: ", "Photo: ", "From one photo by linecad"):
        findings.need(words in text, f"pdftotext does not find {words!r}")
    apart = np.abs(np.subtract(one.shape, other.shape)).max()
    if not findings.need(apart <= 1, f"the page is {one.shape[::-1]} px in poppler, {other.shape[::-1]} in Inkscape"):
        return ""
    rows, columns = np.minimum(one.shape, other.shape)
    inks = [picture[:rows, :columns] < DARK for picture in (one, other)]
    for name, ink, against in (("poppler", *inks), ("Inkscape", *inks[::-1])):
        findings.need(ink.mean() > 0.005, f"{name} shows an empty page")
        stray = (ink & ~grown(against)).sum() / max(ink.sum(), 1)
        findings.need(stray <= STRAY, f"{100 * stray:.1f} % of the ink in {name} is not in the other")
    return f"{columns} x {rows} px at {DPI} dpi, {100 * inks[0].mean():.1f} % ink"


def grown(ink):
    """Where there is ink within APART px."""
    wide = Image.fromarray(np.where(ink, np.uint8(255), np.uint8(0))).filter(ImageFilter.MaxFilter(2 * APART + 1))
    return np.asarray(wide) > 0


def start(*command):
    """Run a program; what it says."""
    words = [str(word) for word in command]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=LIMIT, check=False)
    if ended.returncode != 0:
        raise RuntimeError(f"{words[0]} ended with {ended.returncode}: {ended.stderr.strip()[-200:]}")
    return ended.stdout


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("pdf", type=Path)
    parser.add_argument("svg", type=Path)
    parsed = parser.parse_args()
    sys.exit(run(lambda findings: check(findings, parsed.pdf, parsed.svg)))
