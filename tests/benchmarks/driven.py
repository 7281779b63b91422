"""A running `linecad edit` and a browser on it, for the benchmark of the page and the pictures of the docs."""

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
# Software WebGL, because there may be no graphics card; no sandbox, because root may run this.
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-accelerated-2d-canvas",  # without a card the processor is faster by itself than as one
]
PATIENCE_MS = 180_000


@contextmanager
def served(photo: Path, *options: str) -> Iterator[str]:
    """The address of a page on a photo, with its calibration beside it."""
    camera = str(photo.with_suffix(".json"))
    command = [sys.executable, "-m", "linecad", "edit", str(photo), "--camera", camera, "--no-browser", *options]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        try:
            assert process.stdout
            yield process.stdout.readline().strip()
        finally:
            process.send_signal(signal.SIGINT)


@contextmanager
def opened(address: str, width: int, height: int) -> Iterator[Page]:
    """The page in a window of so many px, with its photo on both sides and its first model."""
    executable = next(filter(None, map(shutil.which, BROWSERS)), None)
    if executable is None:
        raise SystemExit(f"none of {', '.join(BROWSERS)} is installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=FLAGS)
        page = browser.new_page(viewport={"width": width, "height": height})
        page.set_default_timeout(PATIENCE_MS)
        page.goto(address)
        page.wait_for_selector("body[data-photo=shown]")
        while page.evaluate("linecad.store.state.solve.status === null"):
            page.wait_for_timeout(200)
        settle(page)
        yield page
        browser.close()


def settle(page: Page) -> None:
    """All edits are answered, all tiles have come, and the canvases are painted."""
    page.evaluate("linecad.editing.settled()")
    page.wait_for_load_state("networkidle")
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
