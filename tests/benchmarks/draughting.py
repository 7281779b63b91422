"""Scenes as a draughtsman would judge them: python tests/benchmarks/draughting.py SCENE.json ... --datasets DIR ...

The tables of `linecad evaluate` on drawings, for scene files that exist already, so nothing is solved. A scene file is
called DATASET-NAME.json; where one of the folders of --datasets has that name and a photo of that name, its truth is
used. First the means, a column a dataset, then a row a photo. With --before DIR, where scene files of the same names
lie, each mean is told before and after, which is the table of docs/results/draughting.md; --means leaves out the rest.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from linecad.evaluation.bootstrap import mean
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.document import NOTHING, tables_as_markdown
from linecad.evaluation.drawing import DrawingScore, score_drawing
from linecad.evaluation.drawing_tables import TABLES, Reader, drawings
from linecad.evaluation.references import Reference, open_case
from linecad.evaluation.scopes import score_scene
from linecad.io.scene_file import read_scene

Scores = dict[str, dict[str, DrawingScore]]  # by dataset, by the stem of the scene file


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", type=Path, nargs="+", metavar="SCENE.json")
    parser.add_argument("--datasets", type=Path, nargs="+", default=[], metavar="DIR")
    parser.add_argument("--before", type=Path, metavar="DIR")
    parser.add_argument("--means", action="store_true")
    chosen = parser.parse_args()
    cases = {f"{folder.name}-{case.name}": case for folder in chosen.datasets for case in find_dataset(folder).cases}
    stages = [scores_of(chosen.scenes, cases)]
    if chosen.before is not None:
        stages.insert(0, scores_of([chosen.before / path.name for path in chosen.scenes], cases))
    print(means(stages))
    if not chosen.means:
        last = {name: score for scores in stages[-1].values() for name, score in scores.items()}
        print(tables_as_markdown(drawings(last)))


def scores_of(paths: Sequence[Path], cases: Mapping[str, Case]) -> Scores:
    """What is counted of each scene file, against the truth of the case of its name or alone."""
    found: Scores = {}
    for path in paths:
        scene = read_scene(path)
        case = cases.get(path.stem)
        reference = Reference() if case is None else open_case(case)[1]
        depth = None if reference.edges is None else score_scene(scene, reference.edges, reference.dense)
        score = score_drawing(scene, reference, None if depth is None else depth.face_scale)
        found.setdefault(path.stem.partition("-")[0], {})[path.stem] = score
    return found


def means(stages: Sequence[Scores]) -> str:
    """Means by dataset as Markdown, a row a measure; of several stages with arrows between them."""
    names = list(stages[-1])
    heads = [f"{name} ({len(stages[-1][name])})" for name in names]
    rows = [f"| | {' | '.join(heads)} |", "| --- " * (len(names) + 1) + "|"]
    for title, (_, columns) in TABLES.items():
        part = title.removeprefix("Drawing: ").removeprefix("Drawing ")
        for column, read in columns.items():
            cells = [" → ".join(cell(stage[name], read, column.unit) for stage in stages) for name in names]
            if set("".join(cells)) - set(NOTHING + " →"):
                unit = f", {column.unit}" if column.unit else ""
                rows.append(f"| {part}: {column.name}{unit} | {' | '.join(cells)} |")
    return "\n".join(rows) + "\n"


def cell(scores: Mapping[str, DrawingScore], read: Reader, unit: str) -> str:
    """The mean of one measure."""
    found = mean([read(score) for score in scores.values()])
    if found is None:
        return NOTHING
    return f"{100 * found.value:.0f}" if unit == "%" else f"{found.value:.{0 if found.value >= 10 else 1}f}"


if __name__ == "__main__":
    main()
