"""Crops of real photos through the whole program: python tests/benchmarks/crops.py DATASET ... [--views] [--scenes DIR]

Who frames a photo otherwise cuts off other walls, eaves and feet, and what one more tie kept right is wrong. So each
crop (CROPS of parts.py) is one more photo of a known place, which no fit has seen. With --views it is what views.py
shows instead: mirrored photos, turned cameras, less light; one fit has seen these (docs/decisions/0159). Prints recall
and precision of lines, and of all depths where depths are known off the edges too, within 5 %, everything in the file:
the means of each dataset, then a row a crop. With --scenes, the scene files and the crops are left in DIR.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from parts import CROPS
from views import VIEWS, changed

from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.references import open_case
from linecad.evaluation.scopes import score_scene
from linecad.io.scene_file import write_scene
from linecad.options import Options
from linecad.pipeline import reconstruct

Shares = tuple[float, float, float, float]


@dataclass(frozen=True)
class Scored:
    """A crop and its recall and precision, of lines and of all depths."""

    dataset: str
    name: str
    shares: Shares


def try_crop(dataset: str, case: Case, crop: str, scenes: Path | None) -> Scored | None:
    """The scores of a crop of a photo; None where no depth of it is known."""
    photo, reference = changed(*open_case(case), crop)
    if reference.edges is None or len(reference.edges.depth) == 0:
        return None
    name = f"{case.name}-{crop.replace(' ', '-')}"
    scene = reconstruct(photo, Options())
    if scenes is not None:
        write_scene(scene, scenes / f"{dataset}-{name}.json")
        cv2.imwrite(str(scenes / f"{dataset}-{name}.png"), cv2.cvtColor(photo.pixels, cv2.COLOR_RGB2BGR))
    found = score_scene(scene, reference.edges, reference.dense).everything
    dense = found.dense or found.lines
    shares = (found.lines.recall_5, found.lines.precision_5, dense.recall_5, dense.precision_5)
    return Scored(dataset, name, shares)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", type=Path, nargs="+", metavar="DATASET")
    parser.add_argument("--views", action="store_true", help="mirrored photos and turned cameras, not crops")
    parser.add_argument("--scenes", type=Path, metavar="DIR")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    chosen = parser.parse_args()
    if chosen.scenes is not None:
        chosen.scenes.mkdir(parents=True, exist_ok=True)
    with ProcessPoolExecutor(chosen.workers) as pool:
        jobs = [
            pool.submit(try_crop, folder.name, case, crop, chosen.scenes)
            for folder in chosen.datasets
            for case in find_dataset(folder).cases
            for crop in (VIEWS if chosen.views else CROPS)
        ]
        found = [scored for job in jobs if (scored := job.result()) is not None]
    print("| | lines | all depths |\n| --- | --- | --- |")
    for dataset in dict.fromkeys(scored.dataset for scored in found):
        own = [scored for scored in found if scored.dataset == dataset]
        shares = np.mean([scored.shares for scored in own], axis=0).tolist()
        print(_row(f"{dataset}, {len(own)} {'views' if chosen.views else 'crops'}", shares, 3))
        for scored in own:
            print(_row(scored.name, list(scored.shares), 2))


def _row(name: str, shares: list[float], digits: int) -> str:
    lines, dense = (" / ".join(f"{share:.{digits}f}" for share in pair) for pair in (shares[:2], shares[2:]))
    return f"| {name} | {lines} | {dense} |"


if __name__ == "__main__":
    main()
