"""How much of a photo gets a depth, by lines and faces: python tests/benchmarks/dense.py DATASET [--only castle/0012]

DATASET is a folder that `linecad evaluate` knows and whose truth has depth anywhere: our made scenes, castle. For each
photo the share of the points of known depth that get one within 5 % (recall), and of those that get one at all
(precision): by the convex hull of each plane's lines, as linecad drew faces before, and by its faces now. One median
scale a photo, first of component 0 alone, then of all, whose scales are less sure. Where several hulls cover a point,
the nearest counts. Seconds are those that the last stage computed: exact lines, planes and faces. --true-crossings
takes the crossings that are real by the truth of a made photo in place of the solver's, and joins no bodies: what faces
could reach if all decisions about crossings were right.
"""

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from linecad.camera.photo import Photo
from linecad.decide.annotations import annotate
from linecad.decide.decision import decide
from linecad.directions import across, components
from linecad.errors import LinecadError
from linecad.evaluation.datasets import find_dataset
from linecad.evaluation.depth import dense_depths, score
from linecad.evaluation.labels import REAL
from linecad.evaluation.references import Points, Reference, open_case
from linecad.finding import connect, find_lines
from linecad.line_graph import Solution
from linecad.model.build import View, build_scene, find_components
from linecad.model.lifting import lift
from linecad.model.regions.roofs import Sketch
from linecad.options import Options
from linecad.pipeline import reconstruct
from linecad.progress import StageReport
from linecad.scene import Face, Plane, Scene
from solver.options import SolveOptions


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--only", default="", help="photos with this in DATASET/NAME")
    parser.add_argument("--extension", type=float, default=Options.extension)
    parser.add_argument("--true-crossings", action="store_true")
    parser.add_argument("--time-limit", type=float, default=60.0)
    arguments = parser.parse_args()
    options = Options(extension=arguments.extension, solve=SolveOptions(time_limit_s=arguments.time_limit))
    print("| photo | lines | faces | holes | s of the last stage | component 0: hulls | faces | all: hulls | faces |")
    print("| --- " * 9 + "|")
    rows = []
    for folder in arguments.datasets:
        for case in find_dataset(folder).cases:
            if arguments.only not in f"{folder.name}/{case.name}":
                continue
            try:
                photo, reference = open_case(case)
                if reference.dense is None:
                    continue
                clock = Clock()
                if arguments.true_crossings:
                    scene = truly(photo, reference, options, clock.start)
                else:
                    scene = reconstruct(photo, options, on_stage=clock.start)
            except LinecadError as error:
                print(f"| {case.name} | {error} |", flush=True)
                continue
            rows.append(measure(case.name, scene, reference.dense, clock.seconds))
    if rows:
        print("| mean | | | | | " + " | ".join(cell(*pair) for pair in np.mean(rows, axis=0)) + " |")


class Clock:
    """Seconds of computing since the last stage began."""

    def __init__(self) -> None:
        self._began = time.process_time()

    def start(self, _stage: str) -> None:
        self._began = time.process_time()

    @property
    def seconds(self) -> float:
        return time.process_time() - self._began


def truly(photo: Photo, reference: Reference, options: Options, on_stage: StageReport) -> Scene:
    """The scene of the crossings that are real by the truth."""
    found = find_lines(photo)
    _, graph = connect(found, options)
    real = reference.label(graph, found.camera, found.frame.rotation) == REAL
    count = len(graph.segments)
    solution = Solution(
        status="optimal", solver="truth", formulation="gain", objective=0.0, bound=0.0, gap=0.0, seconds=0.0, nodes=0,
        connected=real, is_boundary=np.zeros(count, bool), planar_pairs=np.zeros((0, 3), np.int64),
        log_depth=np.zeros(count),
    )  # fmt: skip
    decision = decide(graph, solution, replace(options, joins="all"), None, annotate(graph, None)[1])
    sketch = None if found.raw is None else Sketch(found.raw, graph.segments.ends, graph.axis)
    view = View(
        photo.name, found.camera, found.frame, found.certainty, count, found.notes, found.pixels, sketch=sketch
    )  # fmt: skip
    groups = find_components(view, graph, decision, lift(graph, decision.real, solution.log_depth))
    on_stage("building planes and faces")
    return build_scene(view, graph, solution, decision, groups)


def measure(name: str, scene: Scene, points: Points, seconds: float) -> list[tuple[float, float]]:
    """Recall and precision of hulls and faces, of component 0 and of all; prints them."""
    hulls = with_hulls(scene)
    pairs = [shares(each, points, main) for main in (True, False) for each in (hulls, scene)]
    holes = sum(len(face.holes) for _, face in scene.faces)
    print(
        f"| {name} | {len(scene.lines)} | {len(scene.faces)} | {holes} | {seconds:.2f} | "
        + " | ".join(cell(*pair) for pair in pairs) + " |",
        flush=True,
    )  # fmt: skip
    return pairs


def cell(recall: float, precision: float) -> str:
    return f"{recall:.2f} / {precision:.3f}"


def shares(scene: Scene, points: Points, main_only: bool) -> tuple[float, float]:
    own = scene.lines.component == 0 if main_only else None
    found = score(dense_depths(scene, points.pixels, own), points.depth)
    return found.recall_5, found.precision_5


def with_hulls(scene: Scene) -> Scene:
    """The scene with the convex hull of each plane's lines as its face."""
    return replace(scene, planes=tuple(replace(plane, faces=hull(scene, plane)) for plane in scene.planes))


def hull(scene: Scene, plane: Plane) -> tuple[Face, ...]:
    """The convex hull of a plane's lines."""
    points = scene.lines.ends[np.isin(scene.lines.id, plane.lines)].reshape(-1, 3)
    flat = components(points, scene.turns)[:, across(np.asarray(plane.axis))]
    if len(flat) == 0 or np.ptp(flat, axis=0).min() == 0:
        return ()
    return (Face(plane.id, points[ConvexHull(flat / np.ptp(flat, axis=0)).vertices]),)


if __name__ == "__main__":
    main()
