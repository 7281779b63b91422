"""The pictures of docs/guide/page.md, of the sample street: python tests/benchmarks/page_pictures.py [FOLDER]"""

import argparse
import io
import shutil
import tempfile
from pathlib import Path

from driven import ROOT, opened, served, settle
from PIL import Image
from playwright.sync_api import Page

LARGE = (1920, 1080)  # px, of the window
SMALL = (1280, 800)
WIDTH = 1280  # px, of the pictures
QUALITY = 82  # of JPEG


def picture(page: Page, path: Path) -> None:
    """Save what the window shows."""
    settle(page)
    image = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    height = round(image.height * WIDTH / image.width)
    image.resize((WIDTH, height), Image.Resampling.LANCZOS).save(path, quality=QUALITY, optimize=True, progressive=True)
    print(f"{path.name}: {path.stat().st_size // 1024} kB")


def overview(page: Page, folder: Path) -> None:
    """All of the photo, and the model from the side."""
    picture(page, folder / "page.jpg")


def correcting(page: Page, folder: Path) -> None:
    """A crossing that a person called fake, near, with its two lines on both sides."""
    chosen = page.evaluate(
        """() => {
          const { state, lines } = linecad.store;
          const inside = ([u, v]) => u > 500 && u < 1000 && v > 250 && v < 600;
          const solid = (id) => lines.get(id)?.component === 0;
          const isDrawn = (each) => linecad.store.drawsCrossing(each, 3); // at the scale below
          const isChosen = (each) => each.real && each.kind === "T" && inside(each.pixel) && isDrawn(each);
          const fits = (each) => isChosen(each) && each.lines.every(solid);
          return state.crossings.find(fits);
        }"""
    )
    page.evaluate("(pixel) => linecad.photo.change((viewport) => viewport.centre(pixel, 3))", chosen["pixel"])
    settle(page)
    box = page.locator("#overlay-canvas").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.move(box["x"] + box["width"] / 2 + 60, box["y"] + box["height"] - 30)
    picture(page, folder / "page-correct.jpg")
    page.keyboard.press("Control+z")
    page.keyboard.press("Escape")
    page.keyboard.press("0")


def bodies(page: Page, folder: Path) -> None:
    """The largest guess, and the most likely of its other places as a ghost."""
    page.evaluate("linecad.model.fit()")
    page.keyboard.press("b")
    page.evaluate(
        """() => {
          const { bodies } = linecad.bodies;
          bodies.select(bodies.list.find((body) => body.guess).id);
        }"""
    )
    page.keyboard.press("Shift+N")
    while not page.evaluate("linecad.bodies.gestures.now?.places && linecad.bodies.gestures.effect !== null"):
        page.wait_for_timeout(100)
    page.mouse.move(4, 4)
    page.evaluate("document.querySelectorAll('#messages button').forEach((each) => each.click())")
    picture(page, folder / "page-bodies.jpg")
    for _ in range(3):
        page.keyboard.press("Escape")
    page.evaluate("linecad.bodies.panel.open(false)")


def labelling(page: Page, folder: Path) -> None:
    """A question of the labelling mode, with the model through the camera."""
    page.keyboard.press("l")
    page.wait_for_timeout(500)
    for key in "rfr":
        settle(page)
        page.keyboard.press(key)
        page.wait_for_timeout(500)
    page.keyboard.press("t")
    page.mouse.move(5, 5)
    picture(page, folder / "page-label.jpg")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=ROOT / "docs" / "guide", help="of the pictures")
    target = parser.parse_args().folder
    with tempfile.TemporaryDirectory() as folder:
        for name in ("street.jpg", "street.json"):
            shutil.copy(ROOT / "samples" / name, folder)
        with served(Path(folder) / "street.jpg", "--quiet") as address:
            with opened(address, *LARGE) as page:
                overview(page, target)
                correcting(page, target)
                bodies(page, target)
            with opened(address, *SMALL) as page:
                labelling(page, target)


if __name__ == "__main__":
    main()
