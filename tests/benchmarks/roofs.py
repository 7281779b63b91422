"""Sloped planes of made towns against the truth: python tests/benchmarks/roofs.py DATASET [--make N] [PHOTO ...]

DATASET holds towns; with --make it is made first, of the N first towns of SEED that show a sloped plane on more than
LEAST of the photo. For each town the true sloped planes that are seen so, and of these how many have a slope found
within 2 degrees, and a face whose depth is within 5 % of theirs in the median, at one scale for the whole photo. Other
arguments are photos whose slopes are told: of those without roofs there should be none.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from linecad.arrays import Bool, Float
from linecad.dataset.make import JUDGED_SIZE, DatasetOptions, Plan, draw_draft, make_dataset, measure, scene_name
from linecad.dataset.truth import NOTHING, Truth

SEED = 90
SIZE, SAMPLES = (1280, 720), 8
LEAST = 0.01  # of the photo
FLATTEST, STEEPEST = np.radians(8.0), np.radians(80.0)
SAME_NORMAL, SAME_OFFSET = np.cos(np.radians(0.5)), 0.005  # of quads in one plane; m
RIGHT_ANGLE, RIGHT_DEPTH = np.radians(2.0), 0.05


@dataclass(frozen=True, eq=False)
class TrueRoof:
    """A sloped plane of the truth and where the photo shows it."""

    normal: Float  # (3,) in the truth's world
    offset: float  # m
    shown: Bool  # (H, W)

    @property
    def share(self) -> float:
        """Of the photo."""
        return float(self.shown.mean())


def true_roofs(truth: Truth) -> list[TrueRoof]:
    """The sloped planes that are seen on more than LEAST of a photo, quads of one plane joined."""
    assert truth.frames is not None
    normal, offset = truth.planes()
    slope = truth.frames.quad_slope
    shown = np.bincount(truth.ids[truth.ids != NOTHING].ravel(), minlength=len(offset))
    left = (shown > 0) & (slope > FLATTEST) & (slope < STEEPEST)
    found = []
    for quad in np.argsort(-shown, kind="stable").tolist():
        if not left[quad]:
            continue
        turn = normal @ normal[quad]
        same = left & (np.abs(turn) > SAME_NORMAL) & (np.abs(offset * np.sign(turn) - offset[quad]) < SAME_OFFSET)
        same[quad] = True
        left &= ~same
        found.append(TrueRoof(normal[quad], float(offset[quad]), np.isin(truth.ids, np.flatnonzero(same))))
    return [roof for roof in found if roof.share > LEAST]


def make(folder: Path, count: int) -> None:
    """Make the towns."""
    options = DatasetOptions(count, SEED, *SIZE, SAMPLES)
    shown, index = [], 0
    while len(shown) < count:
        draft = draw_draft(SEED, index, "town")
        if true_roofs(measure(draft, *JUDGED_SIZE)):
            shown.append(index)
        index += 1
    names = tuple(scene_name(each, "town") for each in shown)
    make_dataset(folder, options, print, Plan(names, lambda place: draw_draft(SEED, shown[place], "town"), "town"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("photos", nargs="*", type=Path)
    parser.add_argument("--make", type=int, metavar="N")
    arguments = parser.parse_args()
    if arguments.make:
        make(arguments.dataset, arguments.make)


if __name__ == "__main__":
    main()
