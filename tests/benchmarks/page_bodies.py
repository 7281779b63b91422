"""How long a word about bodies takes on the page, from the click to the repaint: page_bodies.py PHOTO [--words N]

The photo has its calibration beside it, as PHOTO with .json. The page is driven as a person does: a body is selected, a
key shows another place of it, a second key takes that, undo takes it back. For each: until the page has drawn the
bodies in their places, in the photo and in the model, and of that what the server took. Prints medians and the worst;
the pictures of what was said first go to -o DIR.
"""

import argparse
import shutil
import statistics
import tempfile
from pathlib import Path

from driven import opened, served, settle
from playwright.sync_api import Page

WIDTH, HEIGHT = 1920, 1080  # px, of the window
ASIDE_MS = 400  # after a word, so that the next one does not come while the scene is built of the one before

WATCH = """() => {
  globalThis.took = { shown: [], taken: [], undone: [], answered: [] };
  const painted = { photo: 0, model: 0 };
  document.querySelector("#model-canvas").addEventListener("painted", () => (painted.model = performance.now()));
  document.querySelector("#bodies-canvas").addEventListener("painted", () => (painted.photo = performance.now()));
  let changed = 0; // when what is to be drawn changed last
  linecad.store.listen((names) => names.has("state") && (changed = performance.now()));
  linecad.bodies.gestures.listen(() => (changed = performance.now()));
  const fetching = globalThis.fetch;
  globalThis.fetch = async (...request) => {
    const start = performance.now();
    const answer = await fetching(...request);
    if (/api.(edit|undo|preview)$/.test(request[0])) took.answered.push(performance.now() - start);
    return answer;
  };
  globalThis.timed = async (name, action, isDone) => {
    const start = performance.now();
    action();
    const isDrawn = () => Math.min(painted.photo, painted.model) >= changed;
    while (!isDone() || !isDrawn()) await new Promise((done) => setTimeout(done, 1));
    took[name].push(Math.max(painted.photo, painted.model) - start);
  };
}"""

SHOW = """() => timed("shown", () => linecad.bodies.gestures.begin("place"),
  () => linecad.bodies.gestures.now?.places && linecad.bodies.gestures.effect !== null)"""
TAKE = """() => {
  const { store, bodies } = linecad;
  const before = store.state.facts.length;
  return timed("taken", () => bodies.gestures.take(), () => store.busy === 0 && store.state.facts.length > before);
}"""
UNDO = """() => {
  const { store, editing } = linecad;
  const before = store.state.facts.length;
  return timed("undone", () => editing.undo(), () => store.busy === 0 && store.state.facts.length < before);
}"""


def told(what: str, times: list[float]) -> str:
    return f"{what}: median {statistics.median(times):.0f} ms, worst of {len(times)} {max(times):.0f} ms"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("photo", type=Path)
    parser.add_argument("--words", type=int, default=10)
    parser.add_argument("-o", "--output", type=Path, metavar="DIR")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for path in (chosen.photo, chosen.photo.with_suffix(".json")):
            shutil.copy(path, folder)
        photo = Path(folder) / chosen.photo.name
        with served(photo, "--quiet") as address, opened(address, WIDTH, HEIGHT) as page:
            measure(page, chosen.words, chosen.output)


def measure(page: Page, words: int, output: Path | None) -> None:
    state = page.evaluate(
        "[linecad.store.state.lines.length, linecad.store.state.crossings.length, linecad.store.state.bodies.length]"
    )
    print(f"{state[0]} lines, {state[1]} crossings, {state[2]} bodies, {WIDTH} x {HEIGHT} px window")
    page.keyboard.press("b")
    page.evaluate(WATCH)
    done = 0
    for number in range(1, 1 + 3 * words):
        page.evaluate("(step) => linecad.bodies.bodies.selectNext(step)", 1)
        if done == words or not page.evaluate(
            """async () => {
              const { bodies } = linecad.bodies;
              if (bodies.selected === bodies.reference) return false;
              const token = sessionStorage.getItem("linecad-token");
              const headers = { "X-Linecad-Token": token };
              return (await (await fetch(`/api/places/${bodies.selected}`, { headers })).json()).length > 0;
            }"""
        ):
            continue
        page.evaluate(SHOW)
        picture(page, output, f"{number}-shown")
        page.evaluate(TAKE)
        picture(page, output, f"{number}-taken")
        page.wait_for_timeout(ASIDE_MS)
        page.evaluate(UNDO)
        done += 1
        print(page.evaluate("JSON.stringify(took)"), flush=True)
        while page.evaluate("linecad.store.solve.state === 'running'"):
            page.wait_for_timeout(200)
        settle(page)
    for name, what in (("shown", "another place is shown"), ("taken", "it is taken"), ("undone", "it is undone")):
        print(told(what, page.evaluate(f"took.{name}")))
    print(told("of these the server", page.evaluate("took.answered")))


def picture(page: Page, output: Path | None, name: str) -> None:
    if output is not None:
        output.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=output / f"{name}.png")


if __name__ == "__main__":
    main()
