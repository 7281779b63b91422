"""A real browser on a real server: chromium by Playwright, `linecad edit` in a process of its own, on a made photo."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np
import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Page

ROOT = Path(__file__).resolve().parents[4]
CHROMIUM = "LINECAD_CHROMIUM"  # the browser to drive, when it is not found by its name
NAMES = ("chromium", "chromium-browser", "google-chrome")
# Software WebGL: machines for tests have no graphics card. No sandbox: CI runs as root, which chromium refuses else.
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-accelerated-2d-canvas",  # without a card the processor is faster by itself than as one
]
SIZE = {"width": 1280, "height": 800}
PATIENCE_MS = 60_000  # far more than it takes, since other programs may need the processor
START_S = 100.0


@dataclass
class Served:
    """A running `linecad edit`."""

    process: subprocess.Popen[str]
    address: str
    photo: Path

    @property
    def origin(self) -> str:
        return self.address.split("/#")[0]

    def ask(self, path, value=None):
        """The JSON answer to a request as the page makes it; with `value` it is a POST."""
        headers = {"X-Linecad-Token": self.address.split("#")[1], "Content-Type": "application/json"}
        data = None if value is None else json.dumps(value).encode()
        request = urllib.request.Request(f"{self.origin}/api/{path}", data, headers)
        with urllib.request.urlopen(request, timeout=30) as answer:
            return json.load(answer)

    def end(self, how: signal.Signals = signal.SIGINT) -> None:
        if self.process.poll() is None:
            self.process.send_signal(how)
        self.process.wait(START_S)
        self.process.stdout.close()


@pytest.fixture(scope="session")
def photo_folder(made, tmp_path_factory) -> Path:
    """A folder with a photo of the made scene and its calibration."""
    folder = tmp_path_factory.mktemp("photo")
    cv2.imwrite(str(folder / "boxes.png"), made.image())
    camera = made.camera
    calibration = {"width": camera.width, "height": camera.height, "K": camera.matrix.tolist(), "distortion": []}
    (folder / "boxes.json").write_text(json.dumps(calibration), encoding="utf-8")
    return folder


@pytest.fixture(scope="session")
def long_search(tmp_path_factory) -> Path:
    """A photo whose search takes minutes where segments reach 200 px: the room at half its size."""
    folder = tmp_path_factory.mktemp("room")
    photo = cv2.imread(str(ROOT / "samples" / "room.jpg"))
    size = (photo.shape[1] // 2, photo.shape[0] // 2)
    cv2.imwrite(str(folder / "room.png"), cv2.resize(photo, size, interpolation=cv2.INTER_AREA))
    camera = json.loads((ROOT / "samples" / "room.json").read_text(encoding="utf-8"))
    (focal, _, cx), (_, _, cy), _ = camera["K"]
    K = [[focal / 2, 0, cx / 2 - 0.25], [0, focal / 2, cy / 2 - 0.25], [0, 0, 1]]
    calibration = {"width": size[0], "height": size[1], "K": K, "distortion": []}
    (folder / "room.json").write_text(json.dumps(calibration), encoding="utf-8")
    return folder / "room.png"


@pytest.fixture(scope="session")
def two_frames(tmp_path_factory) -> Path:
    """A photo of two facades that stand at 0.65 rad to each other, with its calibration."""
    folder = tmp_path_factory.mktemp("facades")
    focal, centre = 900.0, (639.5, 479.5)
    picture = np.full((960, 1280, 3), (235, 225, 215), np.uint8)

    def fill(turn, x, y, z, shade):
        """A rectangle of a wall that stands at y in the axes of its frame."""
        flat = np.array([(x[0], z[0]), (x[1], z[0]), (x[1], z[1]), (x[0], z[1])])
        right, away = flat[:, 0] * np.cos(turn) - y * np.sin(turn), flat[:, 0] * np.sin(turn) + y * np.cos(turn)
        pixels = np.column_stack([focal * right / away + centre[0], -focal * flat[:, 1] / away + centre[1]])
        cv2.fillPoly(picture, [np.rint(16 * pixels).astype(np.int32)], shade, cv2.LINE_AA, shift=4)

    for turn, start, y in ((-0.4, -11.0, 10.0), (0.25, 4.5, 12.0)):
        fill(turn, (start, start + 6.2), y, (-1.6, 5.0), (150, 160, 170))
        for column in range(4):
            for row in range(3):
                x, z = start + 0.5 + 1.4 * column, -0.8 + 1.9 * row
                fill(turn, (x, x + 0.9), y, (z, z + 1.3), (60, 50, 45))
    cv2.imwrite(str(folder / "facades.png"), picture)
    K = [[focal, 0, centre[0]], [0, focal, centre[1]], [0, 0, 1]]
    calibration = {"width": 1280, "height": 960, "K": K, "distortion": []}
    (folder / "facades.json").write_text(json.dumps(calibration), encoding="utf-8")
    return folder / "facades.png"


@pytest.fixture(scope="session")
def start(photo_folder, tmp_path_factory) -> Iterator[Callable[..., Served]]:
    """Start `linecad edit` on a copy of the made photo, or again on one that was edited; all end with the tests."""
    running = []

    def begin(*options: str, photo: Path | None = None) -> Served:
        if photo is None:
            folder = tmp_path_factory.mktemp("edit")
            for name in ("boxes.png", "boxes.json"):
                shutil.copy(photo_folder / name, folder)
            photo = folder / "boxes.png"
        camera = str(photo.with_suffix(".json"))
        command = [sys.executable, "-m", "linecad", "edit", str(photo), "--camera", camera, "--no-browser", *options]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
        running.append(process)
        assert process.stdout
        address = process.stdout.readline().strip()
        assert "//127.0.0.1:" in address, f"linecad edit ended with {process.wait(5)}"
        return Served(process, address, photo)

    yield begin
    for process in running:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
    for process in running:
        process.wait(START_S)
        process.stdout.close()


@pytest.fixture(scope="session")
def browser():
    playwright_api = pytest.importorskip("playwright.sync_api", reason="no Playwright: pip install -e '.[dev]'")
    found = os.environ.get(CHROMIUM) or next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip(f"no browser: none of {', '.join(NAMES)} is installed; name one in {CHROMIUM}")
    with playwright_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=FLAGS)
        yield browser
        browser.close()


@dataclass
class Screen:
    """A page in a tab, with what a person would do there."""

    page: "Page"
    served: Served
    complaints: list[str] = field(default_factory=list)  # on the console, but for what a test expects
    requests: list[str] = field(default_factory=list)

    def open(self) -> None:
        """Load the page and wait until the photo is on both sides and the first model is there."""
        self.page.goto(self.served.address)
        self.page.wait_for_selector("body[data-photo=shown]")
        self.wait("linecad.store.solve.state === 'idle'")
        self.settle()

    def run(self, script: str, value=None):
        return self.page.evaluate(script, value)

    def wait(self, condition: str) -> None:
        """Until a condition holds; Playwright's own way needs `eval`, which the page's policy forbids."""
        until = time.monotonic() + PATIENCE_MS / 1000
        while not self.page.evaluate(condition):
            assert time.monotonic() < until, f"waited in vain for {condition}"
            self.page.wait_for_timeout(20)

    def settle(self) -> None:
        """All edits are answered, and the canvases are painted."""
        self.run("linecad.editing.settled()")
        self.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    @property
    def state(self) -> dict:
        return self.run("linecad.store.state")

    @property
    def stage(self) -> dict:
        box = self.page.locator("#overlay-canvas").bounding_box()
        assert box
        return box

    def on_screen(self, pixel) -> tuple[float, float]:
        """Where a pixel of the photo is on the screen, for the mouse."""
        x, y = self.run("(pixel) => linecad.photo.viewport.toScreen(pixel)", list(pixel))
        return self.stage["x"] + x, self.stage["y"] + y

    def in_photo(self, place) -> tuple[float, float]:
        at = [place[0] - self.stage["x"], place[1] - self.stage["y"]]
        return tuple(self.run("(at) => linecad.photo.viewport.toPhoto(at)", at))

    def click(self, pixel) -> None:
        self.page.mouse.click(*self.on_screen(pixel))
        self.settle()

    def press(self, key: str) -> None:
        self.page.keyboard.press(key)
        self.settle()

    def button(self, name: str):
        return self.page.get_by_role("button", name=name)

    @contextmanager
    def holding(self, path: str) -> Iterator[Callable[[], int]]:
        """What the page asks for at a path waits until the block ends; gives how many wait."""
        with self._replying(path, "(ask) => new Promise((go) => held.push(() => go(ask())))"):
            yield lambda: self.run("window.held.length")

    @contextmanager
    def answering(self, path: str, answer) -> Iterator[None]:
        """The page gets this answer, as JSON, to what it asks for at a path."""
        with self._replying(path, f"() => Promise.resolve(Response.json({json.dumps(answer)}))"):
            yield

    @contextmanager
    def _replying(self, path: str, reply: str) -> Iterator[None]:
        """A script replies to what the page asks for at a path; it may keep in `held` what is let go at the end.

        Playwright's own routes now and then lose another request that is on its way when a route ends.
        """
        self.run(
            """(path) => {
              const ask = window.fetch;
              const held = (window.held = []);
              const reply = REPLY;
              window.fetch = (...asked) => (asked[0].includes(path) ? reply(() => ask(...asked)) : ask(...asked));
              window.endReplying = () => {
                window.fetch = ask;
                for (const go of held) go();
              };
            }""".replace("REPLY", reply),
            path,
        )
        try:
            yield
        finally:
            self.run("window.endReplying()")

    def painted(self, canvas: str) -> int:
        """How many px of a canvas hold lines or marks; faces are fainter."""
        script = """(name) => {
          const canvas = document.querySelector(name);
          const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          let count = 0;
          for (let at = 3; at < data.length; at += 4) count += data[at] > 100;
          return count;
        }"""
        return self.run(script, canvas)


def make_screen(context, served: Served) -> Screen:
    context.set_default_timeout(PATIENCE_MS)
    screen = Screen(context.new_page(), served)
    page = screen.page
    page.on("console", lambda message: message.type == "error" and screen.complaints.append(message.text))
    page.on("pageerror", lambda error: screen.complaints.append(f"{error}\n{error.stack}"))
    page.on("request", lambda request: screen.requests.append(request.url))
    return screen


def check(screen: Screen) -> None:
    """Nobody has complained on the console, and no request went to another host."""
    own = (screen.served.origin, f"blob:{screen.served.origin}", "about:")
    assert [url for url in screen.requests if not url.startswith(own)] == []
    assert screen.complaints == []


@pytest.fixture
def new_screen(browser) -> Iterator[Callable[..., Screen]]:
    """A tab on a server, in a browser of its own or beside another one; checked afterwards."""
    screens = []

    def make(served: Served, beside: Screen | None = None, script: str = "") -> Screen:
        context = beside.page.context if beside else browser.new_context(viewport=SIZE)
        if script:
            context.add_init_script(script)
        screens.append(make_screen(context, served))
        return screens[-1]

    yield make
    for screen in screens:
        screen.page.goto("about:blank")
        screen.page.close()
        check(screen)


@pytest.fixture(scope="session")
def shared_screen(browser, start) -> Screen:
    screen = make_screen(browser.new_context(viewport=SIZE), start())
    screen.open()
    return screen


@pytest.fixture
def screen(shared_screen) -> Iterator[Screen]:
    """The page on the server that the tests share, as it was when it was loaded; checked afterwards."""
    screen = shared_screen
    served = screen.served
    while (state := served.ask("state"))["undo"] > 0:
        served.ask("undo", {"base_version": state["version"]})
    screen.page.mouse.move(2, 2)
    screen.run(
        """async () => {
          const { store, editing, photo, model, draft } = linecad;
          await editing.refresh();
          draft.clear();
          linecad.bodies.gestures.leave();
          linecad.bodies.panel.open(false);
          const { EVERYTHING } = await import("/page/store.js");
          const layers = Object.fromEntries(Object.keys(store.layers).map((name) => [name, name !== "cells"]));
          store.set({ layers, tool: "correct", labelling: false, selection: null, hover: null, texture: true });
          store.set({ body: null, many: null });
          store.set({ choice: EVERYTHING, shown: null, colouring: "axis" });
          model.change((orbit) => orbit.throughCamera());
          photo.change((viewport) => viewport.fit());
          model.fit();
          document.activeElement.blur();
          document.querySelector("#messages").replaceChildren(); // errors and warnings catch clicks
        }"""
    )
    screen.settle()
    yield screen
    check(screen)
