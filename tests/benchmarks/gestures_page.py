"""Gestures by the keys of the page, in a browser: python tests/benchmarks/gestures_page.py DATASET NAME [--gestures 6]

The photo NAME of a dataset of known depth is opened by `linecad edit`, and somebody does what gestures.py says, by keys
alone: Shift+PgDn to a body, Shift+K to a part of it, then Shift+N through its other places or Shift+D and arrows, and
Enter. After each the corrections that the page saved are read, by which the next is chosen. Prints recall and precision
at 5 % of everything in the JSON that the page exports, before the first and after each gesture, how long each took
until the model held it, and what the console of the browser told. Pictures of the page go to -o DIR.
"""

import argparse
import shutil
import tempfile
import time
from pathlib import Path

import numpy as np
from driven import opened, served, settle
from gestures import MOST_TIMES, Gesture, in_words, is_worse, next_gesture
from playwright.sync_api import Page

from linecad.corrections.edits import Corrections
from linecad.corrections.file import SUFFIX, read_corrections
from linecad.editing.session import Session
from linecad.editing.solving import TaskSolver
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.depth import DepthScore, score_depth
from linecad.evaluation.references import Points, open_case
from linecad.io.scene_file import read_scene
from linecad.lines.segments import find_segments
from linecad.options import Options

WIDTH, HEIGHT = 1600, 1000  # px, of the window
STEP, FINE_STEP = 0.01, 0.001  # log factors of an arrow key, without and with Shift


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("name", help="of a photo")
    parser.add_argument("--gestures", type=int, default=6)
    parser.add_argument("--undo", action="store_true", help="what makes the model worse is taken back")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR")
    chosen = parser.parse_args()
    (case,) = (case for case in find_dataset(chosen.dataset).cases if case.name == chosen.name)
    with tempfile.TemporaryDirectory() as folder:
        photo = Path(folder) / case.photo.name
        shutil.copy(case.photo, photo)
        shutil.copy(camera_of(case), photo.with_suffix(".json"))
        with served(photo, "--quiet") as address, opened(address, WIDTH, HEIGHT) as page:
            console: list[str] = []
            page.on("console", lambda told: console.append(f"{told.type}: {told.text}"))
            page.on("pageerror", lambda error: console.append(f"error: {error}"))
            play(page, case, photo, chosen.gestures, chosen.undo, chosen.output)
            print(f"console: {console or 'nothing'}")


def camera_of(case: Case) -> Path:
    """The camera file of a photo."""
    if case.camera is not None:
        return case.camera
    return case.truth / "camera.json" if case.truth.is_dir() else case.photo.with_suffix(".json")


def play(page: Page, case: Case, photo: Path, most: int, undoes: bool, output: Path | None) -> None:
    points, moved = open_case(case)[1].edges, list[int]()
    assert points is not None, "no depth is known"
    random = np.random.default_rng(0)
    page.keyboard.press("b")
    score = exported(page, photo, points)
    print(f"{case.name}: {in_words(score)}", flush=True)
    picture(page, output, "0")
    number = undone = 0
    while number < most:
        number += 1
        twin = twin_of(case, photo)
        gesture = next_gesture(twin, points, moved, random)
        if gesture is None:
            break
        began = time.monotonic()
        show(page, twin, gesture)
        picture(page, output, f"{number}-shown")
        page.keyboard.press("Enter")
        settle(page)
        assert page.evaluate("linecad.store.state.facts.length") == number - undone, "the gesture was not taken"
        solved(page)
        took, before = time.monotonic() - began, score
        score = exported(page, photo, points)
        print(f"{gesture.word} ({took:.0f} s) -> {in_words(score)}", flush=True)
        picture(page, output, f"{number}-taken")
        if undoes and is_worse(score, before):
            page.keyboard.press("Control+Z")
            solved(page)
            number, undone, score = number + 1, undone + 2, exported(page, photo, points)
            moved += [gesture.line] * MOST_TIMES
            print(f"undo -> {in_words(score)}", flush=True)


def twin_of(case: Case, photo: Path) -> Session:
    """A session that holds what the page has saved, and a model of it."""
    seen, path = open_case(case)[0], photo.with_name(photo.name + SUFFIX)
    corrections = read_corrections(path) if path.exists() else Corrections(photo.name, seen.width, seen.height)
    session = Session(seen, find_segments(seen.grey), Options(), corrections, lambda _: None)
    session.take(TaskSolver(seen, Options()).answer(session.task(session.now().version), lambda _: None))
    return session


def show(page: Page, twin: Session, gesture: Gesture) -> None:
    """The ghost of a gesture, by keys."""
    model = twin.now().model
    assert model is not None
    assert model.bodies is not None
    own = {model.bodies.ids[line] for line in gesture.thing.lines.tolist()}
    until(page, "Shift+PageDown", f"linecad.bodies.bodies.selected === {body_of(page, own)}")
    if gesture.thing.is_part:
        is_part = "linecad.bodies.gestures.parts.chosen?.lines"
        until(page, "Shift+K", f"(({is_part} ?? []).toSorted().join() === {sorted(own, key=str)}.toSorted().join())")
    page.keyboard.press("Shift+N" if gesture.is_proposed else "Shift+D")
    settle(page)
    if gesture.is_proposed:
        log = "linecad.bodies.gestures.now.log"
        until(page, "ArrowRight", f"Math.abs({log} - {gesture.move}) < {STEP}")
        return
    key = "ArrowDown" if gesture.move > 0 else "ArrowUp"
    whole, fine = divmod(round(abs(gesture.move) / FINE_STEP), round(STEP / FINE_STEP))
    for _ in range(whole):
        page.keyboard.press(key)
    for _ in range(fine):
        page.keyboard.press(f"Shift+{key}")
    while page.evaluate("linecad.bodies.gestures.effect === null"):
        page.wait_for_timeout(50)


def body_of(page: Page, lines: set[int]) -> int:
    """The number on the page of the body that holds most of some lines."""
    of_lines = page.evaluate("linecad.store.state.bodies.map(({ id, lines }) => [id, lines])")
    return int(max(of_lines, key=lambda body: len(lines & set(body[1])))[0])


def until(page: Page, key: str, done: str) -> None:
    """Press a key until something is so."""
    for _ in range(100):
        if page.evaluate(done):
            return
        page.keyboard.press(key)
        settle(page)
    raise SystemExit(f"{key} does not lead to {done}")


def solved(page: Page) -> None:
    """The model holds all that was said."""
    settle(page)
    while page.evaluate("linecad.store.solve.state === 'running' || !linecad.store.solve.fresh"):
        page.wait_for_timeout(200)
    settle(page)


def exported(page: Page, photo: Path, points: Points) -> DepthScore:
    """The score of the JSON that the page's menu saves."""
    page.keyboard.press("e")
    with page.expect_download() as download:
        page.locator("[data-format=json]").click()
    path = photo.with_name("page.json")
    download.value.save_as(path)
    return score_depth(read_scene(path), points.pixels, points.depth)


def picture(page: Page, output: Path | None, name: str) -> None:
    if output is not None:
        output.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=output / f"{name}.png")


if __name__ == "__main__":
    main()
