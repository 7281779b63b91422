"""What each part of the way from a photo to its faces is worth: python tests/benchmarks/ablation.py DATASET ...

DATASET is a folder that `linecad evaluate` knows and whose truth has depth. Each row leaves out one part, or puts in
its place what was there before; printed is the mean recall / precision at 5 % of component 0, of lines (and the lowest
precision of a photo) and of lines and faces together. Rows are compared with the robust fit as solver, which takes
seconds where the search takes its time limit; the first two rows are the search and the fit.
"""

import argparse
import functools
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from dense import with_hulls

import linecad.model.build
from linecad.camera.photo import Photo
from linecad.errors import LinecadError
from linecad.evaluation.datasets import find_dataset
from linecad.evaluation.depth import dense_depths, score, score_depth
from linecad.evaluation.references import Reference, open_case
from linecad.finding import FoundLines, find_lines
from linecad.model.body_scales import join_bodies
from linecad.options import LONG_REACH, MIDDLE_REACH, SHORT_REACH, Options
from linecad.pipeline import reconstruct_lines
from linecad.scene import Scene
from solver.options import SolveOptions

FIT = Options(solve=SolveOptions(fast=True))
Row = Callable[[Photo, float], Scene]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--first", type=int, default=10_000, help="so many photos of each dataset")
    parser.add_argument("--rows", default="", help="rows with this in their name")
    parser.add_argument("--time-limit", type=float, default=10.0, help="seconds of the exact search")
    chosen = parser.parse_args()
    print("| | " + " | ".join(f"{folder.name}: lines | faces" for folder in chosen.datasets) + " |")
    print("| --- " * (1 + 2 * len(chosen.datasets)) + "|")
    for name, row in ROWS.items():
        if chosen.rows not in name:
            continue
        cells = [name]
        for folder in chosen.datasets:
            cells += measure(folder, row, chosen.first, chosen.time_limit)
        print("| " + " | ".join(cells) + " |", flush=True)


def measure(folder: Path, row: Row, first: int, limit: float) -> list[str]:
    """The two cells of a row for one dataset; a photo without a model has recall 0 and no precision."""
    lines, dense = [], []
    for case in find_dataset(folder).cases[:first]:
        photo, reference = open_case(case)
        try:
            scene = row(photo, limit)
        except LinecadError:
            lines.append((0.0, np.nan))
            continue
        if reference.edges is not None:
            own = scene.lines.component == 0
            found = score_depth(scene, reference.edges.pixels, reference.edges.depth, own)
            lines.append((found.recall_5, found.precision_5 if found.with_depth else np.nan))
        if reference.dense is not None:
            dense.append(everywhere(scene, reference))
    return [cell(lines, with_lowest=True), cell(dense, with_lowest=False)]


def everywhere(scene: Scene, reference: Reference) -> tuple[float, float]:
    """Recall and precision of lines and faces of component 0 over all points of known depth."""
    assert reference.dense is not None
    own = scene.lines.component == 0
    found = score(dense_depths(scene, reference.dense.pixels, own), reference.dense.depth)
    return found.recall_5, found.precision_5 if found.with_depth else np.nan


def cell(rows: list[tuple[float, float]], *, with_lowest: bool) -> str:
    if not rows:
        return ""
    recall, precision = np.array(rows).T
    lowest = f" ({np.nanmin(precision):.2f})" if with_lowest else ""
    return f"{recall.mean():.3f} / {np.nanmean(precision):.3f}{lowest}"


def with_options(options: Options) -> Row:
    def row(photo: Photo, limit: float) -> Scene:
        timed = replace(options, solve=replace(options.solve, time_limit_s=limit))
        return finished(photo, find_lines(photo, faint=options.faint), timed)

    return row


def finished(photo: Photo, found: FoundLines, options: Options) -> Scene:
    return reconstruct_lines(photo.name, found, options).scene


def judged(inconsistent: bool) -> Row:
    """Every photo taken for consistent, or for inconsistent."""

    def row(photo: Photo, _limit: float) -> Scene:
        found = find_lines(photo)
        found.__dict__["inconsistency"] = np.inf if inconsistent else 0.0  # what the cached property would compute
        return finished(photo, found, FIT)

    return row


def patched(module: object, name: str, instead: object) -> Row:
    """The defaults with one function replaced."""

    def row(photo: Photo, _limit: float) -> Scene:
        before = getattr(module, name)
        setattr(module, name, instead)
        try:
            return finished(photo, find_lines(photo), FIT)
        finally:
            setattr(module, name, before)

    return row


def hulls(photo: Photo, _limit: float) -> Scene:
    return with_hulls(finished(photo, find_lines(photo), FIT))


ROWS: dict[str, Row] = {
    "exact search": with_options(Options(over_bodies=False)),
    "exact search without planarity": with_options(Options(solve=SolveOptions(without=frozenset({"planarity"})))),
    "robust fit (`--fast`); all below change one thing of it": with_options(FIT),
    "short reach, as in the paper": with_options(replace(FIT, reach=SHORT_REACH)),
    "long reach in every photo": with_options(replace(FIT, reach=LONG_REACH)),
    "middle reach in every photo": with_options(replace(FIT, reach=MIDDLE_REACH)),
    "every photo taken for consistent": judged(False),
    "every photo taken for inconsistent": judged(True),
    "no collinear edges": with_options(replace(FIT, collinear=False)),
    "weights by kind of junction": with_options(replace(FIT, weights="junctions")),
    "all weights one": with_options(replace(FIT, weights="ones")),
    "nothing refused": with_options(replace(FIT, joins="all")),
    "biconnected blocks instead of resampling": with_options(replace(FIT, joins="biconnected")),
    "no window grids that continue": patched(
        linecad.model.build, "join_bodies", functools.partial(join_bodies, enough=np.inf)
    ),
    "a second look for faint segments (`faint=on`)": with_options(replace(FIT, faint=True)),
    "hulls instead of faces": hulls,
}


if __name__ == "__main__":
    main()
