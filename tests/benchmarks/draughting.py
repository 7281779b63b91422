"""Scenes as a draughtsman would judge them: python tests/benchmarks/draughting.py SCENE.json ... --datasets DIR ...

The tables of `linecad evaluate` on drawings, for scene files that exist already, so nothing is solved. A scene file is
called DATASET-NAME.json; where one of the folders of --datasets has that name and a photo of that name,
its truth is used. First a row of means for each dataset, then a row for each photo.
"""

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.document import tables_as_markdown
from linecad.evaluation.drawing import DrawingScore, score_drawing
from linecad.evaluation.drawing_tables import drawing_means, drawings
from linecad.evaluation.references import Reference, open_case
from linecad.evaluation.scopes import score_scene
from linecad.io.scene_file import read_scene


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", type=Path, nargs="+", metavar="SCENE.json")
    parser.add_argument("--datasets", type=Path, nargs="+", default=[], metavar="DIR")
    chosen = parser.parse_args()
    cases = {(folder.name, case.name): case for folder in chosen.datasets for case in find_dataset(folder).cases}
    datasets: dict[str, dict[str, DrawingScore]] = {}
    for path in chosen.scenes:
        dataset, _, name = path.stem.partition("-")
        datasets.setdefault(dataset, {})[path.stem] = score_of(path, cases.get((dataset, name)))
    print(tables_as_markdown(drawing_means(datasets)))
    print(tables_as_markdown(drawings({name: score for each in datasets.values() for name, score in each.items()})))


def score_of(path: Path, case: Case | None) -> DrawingScore:
    """What is counted of the scene in a file, against the truth of a case or alone."""
    scene = read_scene(path)
    reference = Reference() if case is None else open_case(case)[1]
    depth = None if reference.edges is None else score_scene(scene, reference.edges, reference.dense)
    return score_drawing(scene, reference, None if depth is None else depth.face_scale)


if __name__ == "__main__":
    main()
