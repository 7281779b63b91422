"""The photos whose bodies stand worst, with pictures: python tests/benchmarks/worst_photos.py DATASET OUT [--most 10]

Prints a Markdown table, worst recall first: recall and precision at 5 % of all lines as placed, and with every body at
its true scale. OUT/NAME.jpg shows the lines: green where most of their points are right, red where they are wrong, by
the scale of component 0's body; blue where nothing is known.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from ties import at_true_scales, place_bodies
from ties_truth import Judged, densest, judge

from linecad.arrays import Float
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.references import open_case

WIDTH = 800  # px
RIGHT_DEPTH = 0.05
COLOURS = {"right": (64, 140, 13), "wrong": (26, 26, 217), "unknown": (160, 97, 18)}  # BGR


@dataclass(frozen=True, eq=False)
class Seen:
    """A photo as it is placed."""

    name: str
    placed: tuple[float, float]
    at_true_scales: tuple[float, float]
    picture: NDArray[np.uint8]


def see(folder: Path, case: Case) -> Seen | None:
    """Place a photo by the project's own tables."""
    photo = judge(folder.name, case)
    if photo is None:
        return None
    places = place_bodies(photo, photo.candidates)
    reference, log_depth = places.evidence.reference, places.log_depth
    true = photo.score(at_true_scales(photo))
    return Seen(case.name, photo.score(log_depth), true, _picture(case, photo, log_depth, reference))


def _picture(case: Case, photo: Judged, log_depth: Float, reference: int) -> NDArray[np.uint8]:
    pixels = cv2.cvtColor(open_case(case)[0].pixels, cv2.COLOR_RGB2BGR)
    shrunk = WIDTH / pixels.shape[1]
    smaller = cv2.resize(pixels, None, fx=shrunk, fy=shrunk, interpolation=cv2.INTER_AREA)
    picture = np.asarray(smaller, np.uint8) // 2 + 110
    seen = photo.seen
    line = photo.on[seen]
    error = log_depth[line] + photo.log_factor[seen] - photo.log_true[seen]
    own = photo.setting.bodies.body[line] == reference
    error = error - densest(error[own]) if own.any() else error
    for number, ends in enumerate(photo.setting.graph.segments.ends):
        of_line = np.abs(np.expm1(error[line == number])) < RIGHT_DEPTH
        kind = "unknown" if len(of_line) == 0 else "right" if of_line.mean() > 0.5 else "wrong"
        first, second = np.rint(ends * shrunk).astype(int).tolist()
        cv2.line(picture, first, second, COLOURS[kind], 1, cv2.LINE_AA)
    return picture


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--most", type=int, default=10)
    parser.add_argument("--workers", type=int, default=2, help="processes")
    chosen = parser.parse_args()
    cases = find_dataset(chosen.dataset).cases
    with ProcessPoolExecutor(chosen.workers) as pool:
        jobs = [pool.submit(see, chosen.dataset, case) for case in cases]
        found = [seen for job in jobs if (seen := job.result()) is not None]
    chosen.out.mkdir(parents=True, exist_ok=True)
    print("| photo | as placed | at true scales |\n| --- | --- | --- |")
    for seen in sorted(found, key=lambda seen: seen.placed[0])[: chosen.most]:
        cv2.imwrite(str(chosen.out / f"{seen.name}.jpg"), seen.picture, [cv2.IMWRITE_JPEG_QUALITY, 75])
        scores = " | ".join("{:.2f} / {:.2f}".format(*score) for score in (seen.placed, seen.at_true_scales))
        print(f"| {seen.name} | {scores} |")


if __name__ == "__main__":
    main()
