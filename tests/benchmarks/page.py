"""How long the page of `linecad edit` takes from a click to the repaint: python tests/benchmarks/page.py [--clicks N]

The photo is the sample street at 6000 x 4000 px, with an extension of the segments that gives some 4,000 crossings.
Three times of a click on a crossing: what the page's thread computes for it, with the server's answer (processor time,
which other programs do not lengthen); until the page has drawn it (its canvases have their commands); until the browser
has shown it (Event Timing, in steps of 8 ms). And the last two for a step of the wheel, which draws everything anew.
"""

import argparse
import json
import statistics
import tempfile
from pathlib import Path

import cv2
import numpy as np
from driven import ROOT, opened, served, settle
from playwright.sync_api import Page

SCALE = 3.75  # 1600 to 6000 px of width
WIDTH, HEIGHT = 1920, 1080  # px, of the window
LEAST_APART = 9.0  # px of the screen, between crossings that are clicked

WATCH = """() => {
  globalThis.times = { drawn: [], shown: [] };
  let start = null;
  const kinds = ["pointerup", "wheel"];
  for (const kind of kinds) addEventListener(kind, (event) => { start = event.timeStamp; }, true);
  document.querySelector("#overlay-canvas").addEventListener("painted", () => {
    if (start !== null) times.drawn.push(performance.now() - start);
    start = null;
  });
  new PerformanceObserver((list) => {
    for (const entry of list.getEntries()) if (kinds.includes(entry.name)) times.shown.push(entry.duration);
  }).observe({ type: "event", durationThreshold: 16 });
}"""


def large_street(folder: Path) -> Path:
    """The sample street with 24 megapixels, and its calibration."""
    photo = cv2.imread(str(ROOT / "samples" / "street.jpg"))
    assert photo is not None
    size = (round(photo.shape[1] * SCALE), round(photo.shape[0] * SCALE))
    cv2.imwrite(str(folder / "street.jpg"), cv2.resize(photo, size, interpolation=cv2.INTER_CUBIC))
    camera = json.loads((ROOT / "samples" / "street.json").read_text(encoding="utf-8"))
    K = np.array(camera["K"])
    K[:2, 2] += 0.5
    K[:2] *= SCALE
    K[:2, 2] -= 0.5
    calibration = {"width": size[0], "height": size[1], "K": K.tolist(), "distortion": []}
    (folder / "street.json").write_text(json.dumps(calibration), encoding="utf-8")
    return folder / "street.jpg"


def places(page: Page, count: int) -> list[list[float]]:
    """Where on the screen to click: crossings that are drawn, and that no other one is near."""
    drawn = page.evaluate(
        """() => {
          const { left, top } = document.querySelector("#overlay-canvas").getBoundingClientRect();
          const { store, photo } = linecad;
          const drawn = store.state.crossings.filter((each) => store.drawsCrossing(each, photo.viewport.scale));
          return drawn.map(({ pixel }) => photo.viewport.toScreen(pixel))
            .map(([x, y]) => [x + left, y + top]);
        }"""
    )
    at = np.array(drawn)
    chosen = [
        place
        for place in at
        if np.partition(np.linalg.norm(at - place, axis=1), 1)[1] > LEAST_APART and place.min() > 0
    ]
    return [chosen[number % len(chosen)].tolist() for number in range(count)]


def told(what: str, times: list[float]) -> str:
    if not times:
        return f"{what}: faster than can be told"
    ordered = sorted(times)
    return f"{what}: median {statistics.median(times):.1f} ms, worst of {len(times)} {ordered[-1]:.1f} ms"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--clicks", type=int, default=40)
    parser.add_argument("--extension", default="180")
    parsed = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        photo = large_street(Path(folder))
        options = ("--option", f"extension={parsed.extension}", "--time-limit", "5", "--quiet")
        with served(photo, *options) as address, opened(address, WIDTH, HEIGHT) as page:
            counts = page.evaluate("[linecad.store.state.lines.length, linecad.store.state.crossings.length]")
            print(f"{counts[0]} lines, {counts[1]} crossings, 24 megapixels, {WIDTH} x {HEIGHT} px window")
            page.evaluate(WATCH)
            developer = page.context.new_cdp_session(page)
            developer.send("Performance.enable", {"timeDomain": "threadTicks"})

            def busy() -> float:
                """Seconds of the page's thread so far."""
                metrics = developer.send("Performance.getMetrics")["metrics"]
                return float({each["name"]: each["value"] for each in metrics}["TaskDuration"])

            work = []
            for x, y in places(page, parsed.clicks):
                page.mouse.move(x, y)
                settle(page)
                page.evaluate("times.drawn.length = 0")  # hover has drawn too
                before = busy()
                page.mouse.click(x, y)
                settle(page)
                work.append(1000 * (busy() - before))
                page.evaluate("(globalThis.clicks ??= []).push(times.drawn[0])")
            print(told("processor time of a click", work))
            print(told("click to drawn", page.evaluate("clicks.filter(Boolean)")))
            print(told("click to shown", page.evaluate("times.shown")))
            page.evaluate("times.drawn.length = times.shown.length = 0")
            page.mouse.move(700, 500)
            for number in range(parsed.clicks):
                page.mouse.wheel(0, -100 if number % 20 < 10 else 100)
                page.wait_for_timeout(60)
            print(told("wheel to drawn", page.evaluate("times.drawn")))
            print(told("wheel to shown", page.evaluate("times.shown")))


if __name__ == "__main__":
    main()
