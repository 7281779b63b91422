"""What refusing hinges does: `PYTHONPATH=. python tests/benchmarks/hinges.py DATASET ... [--witnesses 1 2 3 4]`.

Each photo is solved once with the default settings; then its solution is parted into bodies for each number of
witnesses (1: nothing is refused) and of lines that may hang on a body. Prints, for each dataset, the mean recall and
precision at 5 % of component 0 and the lowest precision of a photo.
"""

import argparse
import time
from pathlib import Path

import linecad.decide.rigid_bodies
import numpy as np

from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.depth import score_depth
from linecad.evaluation.references import open_case
from linecad.finding import connect, find_lines
from linecad.model.build import place
from linecad.options import Options
from solver.options import SolveOptions
from solver.solve import solve

Variant = tuple[int, int]  # witnesses, lines that may hang on a body


def measure(case: Case, limit: float, variants: list[Variant]) -> dict[Variant, tuple[float, float, float]]:
    """Recall and precision at 5 % and the seconds of `place`, of one photo; no precision where nothing was found."""
    photo, reference = open_case(case)
    if reference.edges is None:
        return {}
    found = find_lines(photo)
    _, graph = connect(found, Options())
    solution = solve(graph, SolveOptions(time_limit_s=limit))
    rows = {}
    for witnesses, hanging in variants:
        linecad.decide.rigid_bodies.HANGING = hanging
        began = time.monotonic()
        scene = place(photo, found, graph, solution, Options(witnesses=witnesses))
        seconds = time.monotonic() - began
        score = score_depth(scene, reference.edges.pixels, reference.edges.depth, scene.lines.component == 0)
        rows[witnesses, hanging] = (score.recall_5, score.precision_5 if score.with_depth else np.nan, seconds)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dataset", type=Path, nargs="+")
    parser.add_argument("--witnesses", type=int, nargs="+", default=[1, 2, 3, 4])
    parser.add_argument("--hanging", type=int, nargs="+", default=[linecad.decide.rigid_bodies.HANGING])
    parser.add_argument("--only", default="", help="photos whose name starts so")
    parser.add_argument("--time-limit", type=float, default=20.0)
    chosen = parser.parse_args()
    variants = [(witnesses, hanging) for witnesses in chosen.witnesses for hanging in chosen.hanging]
    for folder in chosen.dataset:
        rows: list[dict[Variant, tuple[float, float, float]]] = []
        for case in find_dataset(folder).cases:
            if not case.name.startswith(chosen.only):
                continue
            try:
                rows.append(measure(case, chosen.time_limit, variants))
            except LinecadError as error:
                print(f"{case.name}: {error}")
        for variant in variants:
            recall, precision, seconds = np.array([row[variant] for row in rows if row]).T
            print(
                f"{folder.name}, {len(recall)} photos, {variant[0]} witnesses, {variant[1]} hanging: recall "
                f"{recall.mean():.3f}, precision {np.nanmean(precision):.3f} (lowest {np.nanmin(precision):.3f}), "
                f"{seconds.mean():.1f} s | "
                + " ".join(f"{r:.2f}/{p:.2f}" for r, p in zip(recall, precision, strict=True)),
                flush=True,
            )


if __name__ == "__main__":
    main()
